"""Simultaneous localization and mapping (P1 §4.2)."""
import csv
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
    report.paragraph("Relative poses against the relations of Kümmerle et al. where their stamps are those of scans (within 0.5 ms), mean ± sd; "
                     "and the absolute trajectory error against the corrected poses, themselves good to 0.1 to 0.16 m (simulated: exact). `flirt slam` "
                     "is the program's default; `bench slam` has the papers' own front end (flirt) and their rivals, written anew.")
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
    runs = bench_runs(program, size, logs)
    for run in runs:
        if run["method"].split(",")[0] in ("flirt", "olson", "rbpf") and run["relations"]:
            rows.append([run["log"], f"bench slam, {run['method']}; odometry: {run['odometry']}", *(
                f"{float(run[f'relations_{unit}']):.3f} ± {float(run[f'relations_{unit}_sd']):.3f}" for unit in ("m", "deg")), run["relations"], ""])
    rows.sort(key=lambda row: row[0])
    for name in ("fr079", "intel", "fr-clinic (local)", "fr-clinic (global)"):
        for i, method in enumerate(("RBPF, 50 particles", "Graph Olson", "Graph FLIRT")):
            rows.append([name, f"P1 Table 2: {method}", published.P1_TABLE_2[(name, "m")][i], published.P1_TABLE_2[(name, "°")][i], "", ""])
    report.table("table-2", ["data set", "from", "translation m", "rotation °", "relations", "skipped"], rows)
    report.missing("fr-clinic's relations are quoted only. The papers used all relations of the full logs; here only those count whose stamps "
                   "meet a scan exactly.")
    report.table("ate", ["data set", "from", "ATE m, rms", "mean ± sd", "largest", "heading °, rms", "poses"], errors)
    report.subheading("Every front end on the same back end")
    if size.name != "full":
        report.missing(f"In this short form the particle filter has {size.particles} particles (the papers': 50), and the front ends `scan` and "
                       "`icp` are left out.")
    report.table("bench-slam", list(runs[0]), [list(run.values()) for run in runs])


def spread(error: dict) -> str:
    return f"{error['mean']:.3f} ± {error['sd']:.3f}"


def bench_runs(program, size, logs) -> list[dict]:
    """Rows of flirt bench slam; the particle filter's name says how many particles it has."""
    folder = program.folder("bench-slam")
    fewer = () if size.name == "full" else ("--methods", "auto,flirt,olson,rbpf")
    program.run("bench", "slam", *(part for log in logs.corrected for part in ("--log", bench_input(log, logs))), *fewer, "--rbpf-particles",
                size.particles, "-o", folder)
    with (folder / "runs.csv").open() as lines:
        runs = list(csv.DictReader(lines))
    for run in runs:
        if run["method"] == "rbpf":
            run["method"] = f"rbpf, {size.particles} particles"
    return runs


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
    report.missing("Missing: both main-station logs were never published. A simulated tunnel and a simulated station at rush hour stand in; their "
                   "truth is exact.")
    report.paragraph("No odometry and no loop closing: constraints, or the local map, reach back over the last 20 scans. End error: of the last "
                     "pose, when the first is the true one. `auto` is the program's default, `flirt` the papers' front end, `icp` their rival.")
    folder = program.folder("crowds")
    program.run("bench", "slam", "--dynamic", "--places", size.places, "--methods", "auto,flirt,icp", "-o", folder)
    runs = program.read(folder / "summary.json")["dynamic"]
    report.table("crowds", ["place", "method", "scans", "way m", "end error m", "end error °", "ATE m (rms)", "the papers' claim"],
                 [[run["place"], run["method"], run["scans"], f"{run['way_m']:.0f}", f"{run['end_error_m']:.2f}", f"{run['end_error_deg']:.1f}",
                   f"{run['ate']['translation_m']['rmse']:.3f}", published.CROWD_CLAIMS[run["place"]]] for run in runs], paper_columns=(7,))
    if "station" not in size.places:
        report.missing("The station (Fig. 10) is in the full form.")
    for run in runs:
        name = f"{run['place']}-{run['method']}"
        report.svg(folder / f"{name}.svg", f"{run['place']} by {run['method']}: {run['end_error_m']:.2f} m off at the end of {run['way_m']:.0f} m.")
        report.svg(folder / f"{name}-end.svg", f"{run['place']} by {run['method']}: the end of the way.")
