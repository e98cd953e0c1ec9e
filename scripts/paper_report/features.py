"""Features by themselves: the papers' pictures, and the benches of detectors, descriptors and single choices."""
import json

from . import published, synthetic
from .report import with_interval


def pictures(report, program, size, logs) -> None:
    report.heading("Interest points and matches (P1 Fig. 1–4, P2 Fig. 1–5)")
    figure_2(report, program)
    descriptors_of_a_keypoint(report, program, logs)
    detections(report, program, logs)
    match_of_16(report, program, logs)


def figure_2(report, program) -> None:
    report.subheading("Curvature detector on synthetic data (P1 Fig. 2, P2 Fig. 2)")
    folder = program.folder("figure-2")
    log = folder / "scene.log"
    synthetic.write_log(log)
    # All peaks of all scales, as the figure shows them.
    program.run("detect", log, "--scan", 0, "--svg", folder / "scene.svg", "--json", folder / "scene.json", "--curvature-duplicate-radius", 0,
                "--curvature-end-margin", 0, "--curvature-foreground-shift", "false")
    report.svg(folder / "scene.svg", "A background wall, and in front of it a wall with a free edge, a convex and an obtuse concave corner.")
    scales: dict[str, set[int]] = {}
    for keypoint in json.loads(folder.joinpath("scene.json").read_text().splitlines()[0])["keypoints"]:
        place = synthetic.place_of(keypoint["x"], keypoint["y"], keypoint["beam"], keypoint["scale"])
        scales.setdefault(place, set()).add(keypoint["level"] + 1)
    rows = [[place, claim, ", ".join(map(str, sorted(scales.get(place, ())))) or "none"] for place, claim in published.FIGURE_2_CLAIM.items()]
    rows.append(["elsewhere", "", ", ".join(map(str, sorted(scales.get("elsewhere", ())))) or "none"])
    report.table("figure-2", ["place", "papers: found on", "here: found on scales"], rows, paper_columns=(1,))


def descriptors_of_a_keypoint(report, program, logs) -> None:
    log = logs.corrected[-1]
    scan = log.scans // 3
    folder = program.folder("figure-3")
    report.subheading("Descriptors of one interest point (P1 Fig. 3, P2 Fig. 3)")
    for descriptor, note in (("beta-grid", "β-grid: occupancy probability and its variance."), ("shape-context", "Linear local shape context.")):
        file = folder / f"{descriptor}.svg"
        program.run("detect", log.file, "--scan", scan, "--descriptor", descriptor, "--svg", file)
        report.svg(file, f"{note} {log.name}, scan {scan}.")


def detections(report, program, logs) -> None:
    report.subheading("Example detections (P1 Fig. 4, P2 Fig. 5)")
    report.missing("The papers' right-hand picture is outdoors (fr-clinic). That log is not published in a form at hand; a second place "
                   "of the logs at hand stands in.")
    for number, log in enumerate(logs.corrected[-2:]):
        file = program.folder("figure-4") / f"{log.name}.svg"
        program.run("detect", log.file, "--scan", log.scans // 2 + number, "--svg", file)
        report.svg(file, f"{log.name}, scan {log.scans // 2 + number}: interest points with their support regions.")


def match_of_16(report, program, logs) -> None:
    report.subheading("Two scans matched (P1 Fig. 1, P2 Fig. 1)")
    log = logs.corrected[-1]
    folder = program.folder("figure-1")
    query = log.scans // 2
    best = None
    for gap in (1, 2, 3, 5, 8, 12, 16, 20):
        found = program.json(folder / f"{gap}.json", "match", log.file, "--scan", query, "--against", max(0, query - gap), allowed=(0, 4))
        inliers = len(found["alignment"]["inliers"]) if found["alignment"] else 0
        if best is None or abs(inliers - 16) < abs(best[1] - 16):
            best = (max(0, query - gap), inliers)
    program.run("match", log.file, "--scan", query, "--against", best[0], "--svg", folder / "match.svg", allowed=(0, 4))
    report.svg(folder / "match.svg", f"{log.name}, scan {query} on scan {best[0]}: {best[1]} inlier correspondences (the papers' pair: 16).")


def bench(program, name, command, logs, *more):
    folder = program.folder(name)
    return folder, program.json(folder / "result.json", "bench", command, *(log.file for log in logs), "-o", folder, *more)


def location_flags(count: int, partners: int) -> tuple:
    """`count` 0: the papers' 20 a log."""
    return (*(("--locations", count) if count else ()), "--partners", partners)


def detectors(report, program, size, logs) -> None:
    report.heading("Which detector finds the same places again? (P2 Fig. 6)")
    report.paragraph(published.DETECTOR_CLAIM)
    folder, result = bench(program, "detectors", "detectors", logs.corrected, *location_flags(size.locations, size.partners))
    report.paragraph(f"{result['locations']} reference locations (detectors/locations.csv), overlap error {result['overlap_error']}, presence "
                     f"{result['presence_m']} m. “As printed”: every detection of every scale is an interest point, as "
                     "in the papers. “Default”: the program's; detections at a jump of the range move to the nearer beam, and those within "
                     "0.2 m of one of a finer scale are dropped. “Native”: every detector's own support regions; “common”: discs of "
                     "0.5 m for all, so that large regions do not overlap more easily. “Chance”: the points of curvature (or of range) with "
                     "their regions, but each on a random hit: what a score is worth begins there.")
    for selection in ("as-printed", "default"):
        for rule in ("native", "common"):
            report.svg(folder / f"repeatability-{selection}-{rule}.svg", f"{selection.replace('-', ' ')}, {rule} regions; shaded: 95 % over locations.")
    detector_tables(report, "detectors", result)
    if size.many_locations:
        _, many = bench(program, "detectors-300", "detectors", logs.corrected, *location_flags(size.many_locations, 20))
        report.subheading(f"The same with {many['locations']} locations")
        detector_tables(report, "detectors-300", many)


def detector_tables(report, name, result) -> None:
    def row(entry):
        return [entry["selection"], entry["regions"], entry["transform"], entry["detector"],
                with_interval(entry["repeatability"], (entry["repeatability_low"], entry["repeatability_high"])),
                with_interval(entry["curvature_leads_by"], (entry["curvature_leads_by_low"], entry["curvature_leads_by_high"])),
                f"{entry['keypoints_a_scan']:.1f}", entry["locations"]]
    report.table(f"{name}-summary", ["selection", "regions", "transform", "detector", "repeatability, mean of the levels [95 %]",
                                     "curvature leads by [95 %]", "keypoints a scan", "locations"], [row(entry) for entry in result["summary"]])


def descriptors(report, program, size, logs) -> None:
    report.heading("Which features tell places apart? (P2 Fig. 7)")
    report.paragraph(published.DESCRIPTOR_CLAIM)
    folder, result = bench(program, "descriptors", "descriptors", logs.corrected, *location_flags(size.locations, size.partners or 20))
    report.paragraph(f"{result['locations']} reference locations, at most {result['partners']} other views a level of overlap. “All pairs”: every "
                     "pair of descriptors below the threshold is a match, as in the papers; “nearest”: only the nearest one can match, as in "
                     "localization.")
    for region in ("common", "native"):
        for pairs in ("all", "nearest"):
            report.svg(folder / f"precision-recall-{region}-{pairs}.svg", f"{region} regions, {pairs} pairs.")
    descriptor_table(report, "descriptors", result["ranking"])
    report.subheading("Other β-grids, and every distance")
    descriptor_table(report, "descriptor-variants", result["variants"])
    if size.many_locations:
        _, many = bench(program, "descriptors-300", "descriptors", logs.corrected, *location_flags(size.many_locations, 5))
        report.subheading(f"The combinations with {many['locations']} locations")
        descriptor_table(report, "descriptors-300", many["ranking"])


def descriptor_table(report, name, ranking) -> None:
    columns = ("mean", "viewpoint", "noise", "subsampling", "oversampling", "behind_best", "behind_the_papers_choice")

    def row(entry):
        return [entry["regions"], entry["pairs"], entry["features"],
                *(with_interval(entry[column], (entry[f"{column}_low"], entry[f"{column}_high"])) for column in columns),
                entry["correspondences"]]
    rows = sorted((row(entry) for entry in ranking), key=lambda cells: (cells[0], cells[1], -float(cells[3].split()[0])))
    report.table(name, ["regions", "pairs", "features", "average precision, mean of the four [95 %]", *columns[1:5], "behind the best",
                        "behind curvature + β-grid", "correspondences"], rows)


def ablations(report, program, size, logs) -> None:
    report.heading("What does each choice bring?")
    if not size.ablation_every:
        report.missing("Left out in this size of run.")
        return
    report.paragraph("The papers' localization with one parameter changed at a time, on logs that are not among the papers' (they may be "
                     "looked at for tuning). p_GL: right of all queries when only the query leaves the map, least residual. revisit: right "
                     "of the answerable queries when 10 m of travel leave the map. Gains are against the default at the same queries.")
    _, result = bench(program, "ablation", "ablation", logs.tuning, "--every", size.ablation_every,
                      *location_flags(10 if size.ablation_every > 1 else 0, size.partners or 10))
    columns = (("repeatability", "repeatability"), ("p_GL", "p_GL"), ("p_GL_gain", "gain"), ("revisit", "revisit"), ("revisit_gain", "gain in revisit"))

    def row(entry):
        values = [with_interval(entry[key], (entry[f"{key}_low"], entry[f"{key}_high"])) if entry[key] is not None else "as default"
                  for key, _ in columns]
        return [entry["choice"], entry["value"], f"{entry['keypoints_a_scan']:.1f}", *values, f"{entry['p_CL']:.3f}", entry["queries"]]
    report.table("ablation", ["choice", "value", "keypoints a scan", *(f"{title} [95 %]" for _, title in columns), "p_CL", "queries"],
                 [row(entry) for entry in result["ablation"]])
