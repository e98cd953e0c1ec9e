"""Rival keypoints, descriptors and matchers in the papers' place, on the same queries."""
from .report import with_interval


def contenders(report, program, size, logs) -> None:
    report.heading("Do rivals do better? (the arena)")
    if not size.arena_queries:
        report.missing("Left out in this size of run.")
        return
    report.paragraph("FALKO and OC keypoints, CGH descriptors or none, and the clique matcher, each written from its description (docs/arena.md), "
                     "in every combination with the papers' curvature keypoints, β-grids and RANSAC. Rates are by least residual; “paper”: only the query "
                     "leaves the map, “revisit”: 10 m of travel around it. p: McNemar's exact test of revisit against the first row.")
    for log in {log.name: log for log in (*logs.tuning[:1], *logs.corrected[:1])}.values():
        folder = program.folder(f"arena-{log.name}")
        every = max(1, log.scans // size.arena_queries)
        program.run("bench", "arena", log.file, "--every", every, "--detectors", "curvature,falko,oc", "--descriptors",
                    "beta-grid,cgh,none", "--matchers", "ransac,clique", "-o", folder)
        report.subheading(f"{log.name}, every {every}th scan")
        report.svg(folder / "arena-revisit.svg", f"{log.name}: precision and recall, revisit.")
        report.table(f"arena-{log.name}", ["detector", "descriptor", "matcher", "keypoints a scan", "repeatability [95 %]", "paper [95 %]",
                                           "revisit [95 %]", "p", "detect, describe, match µs"],
                     [row(entry) for entry in program.read(folder / "contenders.json")])


def row(entry: dict) -> list:
    rates = [with_interval(entry[name], (entry[f"{name}_low"], entry[f"{name}_high"])) for name in ("repeatability", "paper", "revisit")]
    times = ", ".join(f"{entry[f'{stage}_us']:.0f}" for stage in ("detect", "describe", "match"))
    return [entry["detector"], entry["descriptor"], entry["matcher"], f"{entry['keypoints']:.1f}", *rates, f"{entry['revisit_p']:.3f}", times]
