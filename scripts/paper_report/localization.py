"""Global localization and loop closing from a single scan (P1 §4.1, P2 §IV-D)."""
import math

from . import data, published
from .report import wilson, with_interval

# The papers' own search: pairs drawn at random, as many as the inlier probability asks for, any turn.
AS_PRINTED = ("--ransac-sampling", "random", "--ransac-max-turn-difference", "3.14159")
METHODS = (("as printed, P1: inlier probability .3", (*AS_PRINTED, "--ransac-inlier-probability", "0.3")),
           ("as printed, P2: inlier probability .5", (*AS_PRINTED, "--ransac-inlier-probability", "0.5")),
           ("default: every pair tried", ()))


def share(strategy: dict, key: str, decimals: int = 3) -> str:
    return with_interval(strategy[key], strategy[f"{key}_wilson"], decimals)


def recall_at_95(strategy: dict, queries: int) -> str:
    return with_interval(strategy["p_cl"], wilson(strategy["p_cl"], queries))


def tables(report, program, size, logs) -> None:
    report.heading("Localization from one scan (P1 Fig. 5, Table 1; P2 Fig. 8, Table I)")
    report.paragraph("Each scan is matched with all others of its log: only the scan itself leaves the map, its neighbours in time stay. A pose is "
                     "right within 0.5 m and 10° of the truth. p_GL: right of all queries at n = 3 inliers (the papers' figures equal this reading). "
                     "p_LC: recall at precision 0.95. t_ss: one pair of scans matched, mean; t_sm: that times the scans of the map, as in the "
                     "papers. Strategies: c closest to the truth, r least residual.")
    rows, figures = [], []
    for log in logs.corrected + logs.stand_ins:
        for number, (method, flags) in enumerate(METHODS):
            folder = program.folder(f"localization/{log.name}-{number}")
            result = program.json(folder / "result.json", "bench", "localization", log.file, "--protocol", "paper", "--every", size.every, "-o",
                                  folder, *flags)
            rows.append(measured(log, method, result))
            if log in logs.corrected:
                figures.append((folder / "localization.svg", f"{log.name}, {method}; {result['queries']} queries, shaded: Wilson 95 %."))
        rows += printed(log.published)
    for name in ("fr-clinic", "Victoria Park"):
        rows += printed(name)
    report.missing("Missing: fr-clinic and Victoria Park, the outdoor logs, are not at hand: their rows are quoted. Stand-ins, simulated: "
                   + "; ".join(f"{log.name} for {log.stands_for}" for log in logs.stand_ins) + ".")
    report.table("table-1", ["data set", "from", "size m", "map scans", "queries", "n_IP", "p_GL c [95 %]", "by blocks", "p_LC c [95 %]",
                             "p_GL r [95 %]", "by blocks ", "p_LC r [95 %]", "t_sm ms", "t_ss µs"], rows)
    for file, caption in figures:
        report.svg(file, caption)
    revisit(report, program, size, logs)


def measured(log, method: str, result: dict) -> list:
    cells = [log.name, method, "", result["map_scans"], result["queries"], f"{result['features_per_scan']:.1f}"]
    for name in ("closest", "residual"):
        strategy = result["strategies"][name]
        low, high = strategy["p_gl_bootstrap"]
        cells += [share(strategy, "p_gl"), f"[{low:.3f}, {high:.3f}]", recall_at_95(strategy, result["queries"])]
    per_pair = result["time_us"]["per_pair"]
    return [*cells, f"{per_pair * result['map_scans'] / 1000:.1f}", f"{per_pair:.1f}"]


def printed(name: str) -> list[list]:
    rows = []
    if name in published.P1_TABLE_1:
        size, scans, points, gl_c, lc_c, gl_r, lc_r, t_sm, t_ss = published.P1_TABLE_1[name]
        rows.append([name, "P1 Table 1", size, scans, scans, points, f"{gl_c:.2f}", "", f"{lc_c:.2f}", f"{gl_r:.2f}", "", f"{lc_r:.2f}",
                     f"{1000 * t_sm:.0f}", t_ss])
    if name in published.P2_TABLE_1:
        size, scans, points, gl, lc, t_sm, t_ss = published.P2_TABLE_1[name]
        rows.append([name, "P2 Table I (one strategy)", size, scans, scans, points, f"{gl:.2f}", "", f"{lc:.2f}", "", "", "", f"{1000 * t_sm:.0f}",
                     t_ss])
    return rows


def revisit(report, program, size, logs) -> None:
    report.subheading("The harder question, not in the papers: is a place recognised from an earlier visit?")
    report.paragraph("10 m of travel around each query leave the map, so that its neighbours in time cannot help. Right of the answerable queries "
                     "(half of what the query sees is in some remaining scan), by the papers' matching of single scans and by the program's "
                     "default, which asks all map scans at once.")
    rows = []
    for log in logs.corrected:
        for method in ("papers", "auto"):
            folder = program.folder(f"revisit/{log.name}-{method}")
            every = max(size.every, 2 if size.name == "full" else 4)
            result = program.json(folder / "result.json", "bench", "localization", log.file, "--protocol", "revisit", "--every", every, "-o", folder,
                                  "--method", method)
            found = result["revisit"]
            low, high = found["success_bootstrap"]
            rows.append([log.name, method, result["queries"], result["answerable"], share(found, "success"), f"[{low:.3f}, {high:.3f}]",
                         with_interval(found["recall_at_99"], wilson(found["recall_at_99"], result["answerable"])),
                         f"{result['time_us']['per_query_median'] / 1000:.1f}"])
    report.table("revisit", ["data set", "method", "queries", "answerable", "right [95 %]", "by blocks", "recall at precision .99 [95 %]",
                             "a query, ms"], rows)


def hypotheses(report, program, size, logs) -> None:
    report.heading("Unique and ambiguous places (P1 Fig. 6)")
    log = next((log for log in logs.corrected if log.name == "intel"), logs.corrected[0])
    folder = program.folder("figure-6")
    map_file = folder / "map.flirt"
    data.write_every_second_scan(log.file, folder / "half.log")
    program.run("map", folder / "half.log", "-o", map_file)
    report.paragraph("The map holds every second scan of the log, and scans that are not in it are looked for, by the papers' matching.")
    every = 2 * max(1, log.scans // 240)
    answers = program.json(folder / "answers.json", "localize", map_file, log.file, "--every", every, "--method", "papers", allowed=(0, 4))["queries"]
    for verdict, note in (("unique", "Left in the paper: one place."), ("ambiguous", "Right in the paper: more than one hypothesis.")):
        candidates = [query for query in answers if query["verdict"] == verdict and (verdict == "unique" or second_place(query) > 2)]
        if not candidates:
            report.missing(f"None of {len(answers)} scans asked was {verdict}" + (", with places more than 2 m apart." if verdict != "unique" else "."))
            continue
        scan = (candidates[len(candidates) // 2] if verdict == "unique" else min(candidates, key=lambda query: query["confidence"]))["scan"]
        program.run("localize", map_file, log.file, "--scan", scan, "--method", "papers", "--svg", folder / f"{verdict}.svg", allowed=(0, 4))
        report.svg(folder / f"{verdict}.svg", f"{note} {log.name}, scan {scan}; {len(candidates)} of {len(answers)} scans asked were {verdict}.")


def second_place(query: dict) -> float:
    """Distance between the best and the second hypothesis, m; 0 when there is one only."""
    places = query["hypotheses"]
    return 0.0 if len(places) < 2 else math.dist((places[0]["x"], places[0]["y"]), (places[1]["x"], places[1]["y"]))
