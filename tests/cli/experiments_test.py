#!/usr/bin/env python3
"""The papers' experiments from outside: flirt bench detectors, descriptors, ablation.

usage: experiments_test.py FLIRT_PROGRAM
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([FLIRT, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)


class Experiments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "small.log"
        done = run("simulate", "-o", cls.log, "--log-poses", "truth", "--rounds", 1, "--office-area", 200, "--quiet")
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def ok(self, *arguments: object) -> None:
        done = run(*arguments)
        self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stderr}")

    def rows(self, file: pathlib.Path) -> list[dict]:
        with file.open() as lines:
            return list(csv.DictReader(lines))

    def test_detectors_bench_writes_the_same_numbers_in_every_form(self):
        out = self.work / "detectors"
        self.ok("bench", "detectors", self.log, "--locations", 3, "--partners", 2, "-o", out, "--json", out / "again.json", "--quiet")
        result = json.loads((out / "detectors.json").read_text())
        self.assertEqual(result, json.loads((out / "again.json").read_text()))
        rows = self.rows(out / "repeatability.csv")
        self.assertEqual(len(rows), len(result["repeatability"]))
        for row, entry in zip(rows, result["repeatability"]):
            self.assertAlmostEqual(float(row["repeatability"]), entry["repeatability"], places=4)
            self.assertLessEqual(entry["repeatability_low"], entry["repeatability"])
            self.assertLessEqual(entry["corresponding"], entry["present"])
        self.assertEqual({row["detector"] for row in rows}, {"curvature", "range", "normal-edge", "normal-blob", "chance", "chance, as range"})
        self.assertEqual(len(self.rows(out / "locations.csv")), 3)
        for selection in ("as-printed", "default"):
            for rule in ("native", "common"):
                self.assertIn("<svg", (out / f"repeatability-{selection}-{rule}.svg").read_text())
        self.assertIn("<svg", (out / "report.html").read_text())
        for entry in result["repeatability"]:
            if entry["transform"] == "noise" and entry["level"] == 0 and not entry["detector"].startswith("chance"):
                self.assertEqual(entry["repeatability"], 1, "the unchanged scan")

    def test_descriptors_bench_ranks_all_combinations_on_any_number_of_threads(self):
        results = []
        for threads in (1, 3):
            out = self.work / f"descriptors-{threads}"
            self.ok("bench", "descriptors", self.log, "--locations", 2, "--partners", 1, "-o", out, "--threads", threads, "--quiet")
            results.append((out / "descriptors.json").read_text())
        self.assertEqual(*results)
        ranking = json.loads(results[0])["ranking"]
        self.assertEqual(len(ranking), 8 * 2 * 2)
        for rules in ((regions, pairs) for regions in ("native", "common") for pairs in ("all", "nearest")):
            group = [entry for entry in ranking if (entry["regions"], entry["pairs"]) == rules]
            self.assertEqual(min(entry["behind_best"] for entry in group), 0)
            self.assertEqual(group[0]["behind_the_papers_choice"], 0)
        curves = self.rows(self.work / "descriptors-1" / "precision-recall.csv")
        self.assertTrue(all(0 <= float(row["precision"]) <= 1 and 0 <= float(row["recall"]) <= 1 for row in curves))

    def test_ablation_compares_with_the_default(self):
        out = self.work / "ablation"
        self.ok("bench", "ablation", self.log, "--every", 40, "--locations", 1, "--partners", 1, "-o", out, "--quiet")
        rows = self.rows(out / "ablation.csv")
        self.assertEqual(rows[0]["choice"], "default")
        self.assertEqual(float(rows[0]["p_GL_gain"]), 0)
        self.assertLess({"geodesic distance", "duplicate radius", "foreground shift", "number of scales", "threshold", "RANSAC inlier probability"},
                        {row["choice"] for row in rows})

    def test_bad_input_exits_2_and_writes_nothing(self):
        without_poses = self.work / "without-poses.log"
        without_poses.write_text("# no scans\n")
        for command in ("detectors", "descriptors", "ablation"):
            out = self.work / f"none-{command}"
            for log in (without_poses, self.work / "missing.log"):
                done = run("bench", command, self.log, log, "-o", out)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(str(log), done.stderr)
                self.assertFalse(out.exists())
            self.assertEqual(run("bench", command).returncode, 1)

    def test_speed_by_map_size_compares_the_index_with_the_exact_answer(self):
        out = self.work / "speed"
        self.ok("bench", "speed", "--sections", "map-size", "--sizes", "150,600", "--queries", 6, "--log", self.log, "-o", out,
                "--quiet")
        rows = self.rows(out / "speed-map-size.csv")
        self.assertEqual([(row["map_scans"], row["method"]) for row in rows],
                         [("150", "exact"), ("150", "words"), ("600", "exact"), ("600", "words")])
        for row in rows:
            self.assertGreater(float(row["recall_of_exact"]), 0.5, row)
            self.assertGreater(float(row["right"]), 0.5, row)
        self.assertTrue((out / "speed-map-size.svg").exists())
        self.assertIn("map-size", json.loads((out / "speed.json").read_text()))
        self.assertFalse((out / "speed-stages.csv").exists())

    def test_speed_refuses_a_log_without_poses(self):
        log = self.work / "no_poses.log"
        log.write_text("FLASER 3 1.0 1.0 1.0 0 0 0 0 0 0 1.0 host 1.0\n")
        done = run("bench", "speed", "--sections", "map-size", "--log", log, "-o", self.work / "refused")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("expected two or more scans with poses", done.stderr)
        self.assertFalse((self.work / "refused").exists())


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
