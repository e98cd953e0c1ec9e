"""Simultaneous localization and mapping (P1 §4.2)."""
import json

from . import published
from .report import with_interval


def folder_of(program, log, run):
    return program.folder(f"slam/{log.name}-{run.name.replace(', ', '-').replace(' ', '-')}")


def maps(report, program, size, logs) -> None:
    report.heading("Maps (P1 Fig. 7, Fig. 8)")
    report.paragraph("Made by flirt slam from raw odometry, or from the scans alone. The front end aligns whole scans with the map of the last "
                     "metres; the loop closer asks all older scans. The papers' front end matches features scan by scan.")
    report.missing("Missing: fr-clinic (Fig. 8) is not at hand; the other logs stand in.")
    for log in logs.corrected:
        for run in log.runs:
            folder = folder_of(program, log, run)
            program.run("slam", run.file, "-o", folder, *(() if run.odometry else ("--no-odometry",)))
            summary = json.loads((folder / "summary.json").read_text())
            report.png(folder / "map.png", f"{log.name}, {run.name}: {summary['scans']} scans, {summary['closures']} closures.")


def relations(report, program, size, logs) -> None:
    report.heading("Accuracy of the maps (P1 Table 2)")
    report.paragraph("Relative poses against the relations of Kümmerle et al. where their stamps are those of scans (within 0.5 ms), mean ± sd; and "
                     "the absolute trajectory error against the corrected poses, themselves good to 0.1 to 0.16 m (simulated: exact).")
    rows, errors = [], []
    for log in logs.corrected:
        for run in log.runs:
            folder = folder_of(program, log, run)
            if log.relations:
                found = program.json(folder / "relations.json", "evaluate", folder / "trajectory.tum", "--relations", log.relations)["relations"]
                error = found["difference"]
                rows.append([log.name, f"flirt slam, {run.name}", spread(error["translation_m"]), spread(error["rotation_deg"]), found["count"],
                             found["skipped"]])
            # Stamps of a TUM file have six digits, those of a simulated log fewer.
            tolerance = ("--stamp-tolerance", 0.001) if logs.simulated else ()
            found = program.json(folder / "truth.json", "evaluate", folder / "trajectory.tum", "--truth", run.truth, *tolerance)
            error = found["ate"]
            errors.append([log.name, f"flirt slam, {run.name}", with_interval(error["translation_m"]["rmse"]), spread(error["translation_m"]),
                           with_interval(error["translation_m"]["max"]), with_interval(error["rotation_deg"]["rmse"]), found["pairs"]])
    for name in ("fr079", "intel", "fr-clinic (local)", "fr-clinic (global)"):
        for i, method in enumerate(("RBPF, 50 particles", "Graph Olson", "Graph FLIRT")):
            rows.append([name, f"P1 Table 2: {method}", published.P1_TABLE_2[(name, "m")][i], published.P1_TABLE_2[(name, "°")][i], "", ""])
    report.table("table-2", ["data set", "from", "translation m", "rotation °", "relations", "skipped"], rows)
    report.missing("fr-clinic's relations are quoted only. The papers used all relations of the full logs; here only those count whose stamps "
                   "meet a scan exactly.")
    report.table("ate", ["data set", "from", "ATE m, rms", "mean ± sd", "largest", "heading °, rms", "poses"], errors)
    rivals(report, program, size, logs)


def spread(error: dict) -> str:
    return f"{error['mean']:.3f} ± {error['sd']:.3f}"


def rivals(report, program, size, logs) -> None:
    report.subheading("Rivals on the same back end")
    if not program.has_bench("slam"):
        report.missing("This version of the program has no `flirt bench slam`: the rivals (particle filter, correlative matcher, ICP) are quoted "
                       "from the papers only.")
        return
    folder = program.folder("bench-slam")
    fewer = () if size.name == "full" else ("--methods", "auto,flirt,olson,rbpf", "--rbpf-particles", 4)
    if fewer:
        report.missing("In this short form the particle filter has 4 particles, and the front ends `scan` and `icp` are left out.")
    program.run("bench", "slam", *(part for log in logs.corrected for part in ("--log", bench_input(log, logs))), *fewer, "-o", folder)
    lines = [line.split(",") for line in (folder / "runs.csv").read_text().splitlines()]
    report.table("bench-slam", lines[0], lines[1:])


def bench_input(log, logs) -> str:
    """A log with raw odometry if there is one, else with synthetic odometry, as `flirt bench slam --log` wants it."""
    run = log.runs[0]
    parts = [f"{log.name}={run.file}"]
    if run.truth != run.file:
        parts.append(f"truth={run.truth}")
    if log.relations:
        parts.append(f"relations={log.relations}")
    if not run.odometry and not logs.simulated:
        parts.append("odometry=synthetic")
    return ",".join(parts)


def crowds(report, program, size, logs) -> None:
    report.heading("Incremental mapping among people (P1 Fig. 9, Fig. 10)")
    report.missing("Missing: both main-station logs were never published. Simulated corridors full of people stand in; their truth is exact.")
    report.paragraph("No odometry and no loop closing: each scan is placed in the map of the last 20 scans. The same drive with and without "
                     "people.")
    folder = program.folder("crowds")
    rows = []
    for people in (0, 40 if size.name != "smallest" else 10):
        name = f"people-{people}"
        log, truth = folder / f"{name}.log", folder / f"{name}.truth.tum"
        program.run("simulate", "-o", log, "--truth", truth, "--office-area", size.area, "--office-corridor-width", 3, "--rounds", 1, "--people",
                    people, "--odometry-mode", "none")
        program.run("slam", log, "-o", folder / name, "--window", 20)
        found = program.json(folder / name / "truth.json", "evaluate", folder / name / "trajectory.tum", "--truth", truth, "--stamp-tolerance", 0.001)
        rpe = found["rpe"]
        rows.append([people, found["pairs"], with_interval(found["ate"]["translation_m"]["rmse"]), with_interval(found["ate"]["translation_m"]["max"]),
                     with_interval(rpe["translation_m"]["rmse"], decimals=4), with_interval(rpe["rotation_deg"]["rmse"])])
        report.png(folder / name / "map.png", f"{people} people: map of the last 20 scans carried along, no loop closed.")
    report.table("crowds", ["people", "scans", "ATE m (rms)", "largest error m", "error a metre driven, m (rms)", "° (rms)"], rows)
