#!/usr/bin/env python3
"""`flirt bench slam` and the simulated station from outside.

usage: bench_slam_test.py FLIRT_PROGRAM
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


class BenchSlam(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "building.log"
        done = run("simulate", "-o", cls.log, "--rounds", 1, "--seed", 3, "--office-area", 500, "--drive-round-length", 25,
                   "--quiet")
        assert done.returncode == 0, done.stderr
        cls.out = cls.work / "bench"
        cls.done = run("bench", "slam", "--log", f"small={cls.log},truth={cls.log}.truth.tum,bound=0.5", "--methods",
                       "scan,rbpf", "--rbpf-particles", 4, "--starts", 2, "--json", cls.work / "bench.json", "-o", cls.out)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def fails(self, code: int, says: str, *arguments: object):
        done = run("bench", "slam", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(says, done.stderr)

    def test_runs_each_method_with_odometry_and_without(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        result = json.loads((self.work / "bench.json").read_text())
        rows = {(row["method"], row["odometry"]): row for row in result["logs"][0]["runs"]}
        self.assertEqual(set(rows), {("corrected", "none"), ("odometry", "own"), ("scan", "own"), ("scan", "none"),
                                     ("rbpf", "own"), ("rbpf", "none")})
        self.assertLess(rows["scan", "own"]["ate"]["translation_m"]["rmse"], 0.05)
        self.assertLess(rows["rbpf", "own"]["ate"]["translation_m"]["rmse"], 0.15)
        self.assertEqual(rows["scan", "own"]["closures"]["wrong"], 0)
        self.assertLess(rows["scan", "own"]["rpe"]["translation_m"]["rmse"], 0.05)
        self.assertEqual(rows["scan", "own"]["relations"]["source"], "derived")
        self.assertGreater(rows["scan", "own"]["relations"]["count"], 0)
        self.assertEqual(result["starts"][0]["within"], 2)
        self.assertEqual(len(result["starts"][0]["ate_m"]), 2)

    def test_writes_tables_trajectories_and_pictures(self):
        with (self.out / "runs.csv").open() as file:
            self.assertEqual(len(list(csv.DictReader(file))), 6)
        report = (self.out / "report.html").read_text()
        self.assertEqual(report.count("<figure>"), 6)
        self.assertEqual({path.name for path in self.out.glob("*.svg")},
                         {f"small-{name}.svg" for name in ("corrected", "odometry", "scan", "scan-no-odometry", "rbpf",
                                                           "rbpf-no-odometry")})
        scans = json.loads((self.out / "summary.json").read_text())["logs"][0]["scans"]
        for name in ("small-scan.tum", "small-rbpf.tum", "small-scan-no-odometry.tum"):
            self.assertEqual(len((self.out / name).read_text().splitlines()), scans)
        truth = self.work / "building.log.truth.tum"
        checked = run("evaluate", self.out / "small-scan.tum", "--truth", truth, "--json", "-")
        row = next(line for line in csv.DictReader((self.out / "runs.csv").open()) if line["method"] == "scan")
        self.assertAlmostEqual(json.loads(checked.stdout)["ate"]["translation_m"]["rmse"], float(row["ate_m"]), 4)

    def test_says_what_is_wrong_with_its_options(self):
        self.fails(1, "expected --log, --dynamic or --long", "-o", self.work / "none")
        self.fails(1, "NAME=FILE", "--log", self.log, "-o", self.work / "none")
        self.fails(1, "'colour'", "--log", f"a={self.log},colour=red", "-o", self.work / "none")
        self.fails(1, "own, synthetic or none", "--log", f"a={self.log},odometry=good", "-o", self.work / "none")
        self.fails(2, "no-such.log", "--log", f"a={self.work}/no-such.log", "-o", self.work / "none")
        self.fails(2, "true pose for each scan", "--log", f"a={self.log},odometry=synthetic", "-o", self.work / "none")

    def test_simulates_the_other_made_up_plans(self):
        for plan in ("corridors", "tunnel", "station", "warehouse"):
            length = ["--station-length", 60] if plan == "station" else []
            done = run("simulate", "-o", self.work / f"{plan}.log", "--plan", plan, "--rounds", 1, "--lidar-beams", 30,
                       *length, "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
