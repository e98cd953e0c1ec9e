#!/usr/bin/env python3
"""flirt localize --track and --join, and flirt bench tracking, from outside.

usage: tracking_test.py FLIRT_PROGRAM
"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""
READINGS = slice(9, 369)  # of the words of a ROBOTLASER1 line, as the next two
LASER_POSE = slice(370, 373)
ROBOT_POSE = slice(373, 376)


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([FLIRT, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)


def scan_lines(log: pathlib.Path) -> list[list[str]]:
    return [line.split() for line in log.read_text().splitlines() if line.startswith("ROBOTLASER1")]


def write_lines(log: pathlib.Path, lines: list[list[str]]) -> pathlib.Path:
    log.write_text("".join(" ".join(line) + "\n" for line in lines))
    return log


def pose_of(line: list[str], at: slice) -> tuple[float, float, float]:
    x, y, theta = map(float, line[at])
    return x, y, theta


def compose(a, b):
    return (a[0] + math.cos(a[2]) * b[0] - math.sin(a[2]) * b[1], a[1] + math.sin(a[2]) * b[0] + math.cos(a[2]) * b[1],
            a[2] + b[2])


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


class Tracking(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "office.log"
        common = ("--rounds", 1, "--office-area", 300, "--seed", 3, "--drive-round-length", 60, "--quiet")
        done = run("simulate", "-o", cls.log, "--log-poses", "truth", *common)
        assert done.returncode == 0, done.stderr
        cls.map = cls.work / "office.flirt"
        done = run("map", cls.log, "-o", cls.map, "--quiet")
        assert done.returncode == 0, done.stderr
        cls.drive = cls.work / "drive.log"  # the same way as a robot would log it: drifting odometry, no true poses
        done = run("simulate", "-o", cls.drive, "--truth", cls.work / "truth.tum", *common)
        assert done.returncode == 0, done.stderr
        cls.truth = [[float(word) for word in line.split()[1:3]]
                     for line in (cls.work / "truth.tum").read_text().splitlines() if not line.startswith("#")]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def json(self, *arguments: object) -> dict:
        done = run(*arguments, "--json", "-")
        self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return json.loads(done.stdout)

    def head(self, name: str, scans: int) -> pathlib.Path:
        return write_lines(self.work / name, scan_lines(self.drive)[:scans])

    def test_ambiguous_places_are_found_places(self):
        summary = self.json("localize", self.map, self.head("short.log", 1), "--track")["summary"]
        self.assertEqual((summary["unique"], summary["ambiguous"] > 0), (0, True), "exit code 0 all the same")

    def is_right(self, query: dict, scan: int) -> bool:
        x, y = self.truth[scan]
        return query["verdict"] == "unique" and math.hypot(query["robot"]["x"] - x, query["robot"]["y"] - y) < 0.5

    def test_a_drive_is_followed_with_a_line_for_each_scan(self):
        log = self.head("head.log", 40)
        result = self.json("localize", self.map, log, "--track")
        self.assertEqual(result["odometry"], "own")
        self.assertEqual([query["scan"] for query in result["queries"]], list(range(40)))
        for query in result["queries"]:
            for key in ("stamp", "verdict", "reason", "confidence", "points", "effective_particles", "places", "time_us"):
                self.assertIn(key, query)
            self.assertEqual(len(query["robot"]["covariance"]), 9)
            best = query["hypotheses"][0]
            self.assertEqual(set(best), {"x", "y", "theta", "covariance", "weight", "score", "evidence"})
        right = [self.is_right(query, i) for i, query in enumerate(result["queries"])]
        self.assertGreater(sum(right[10:]), 27, "30 scans, all but a few")
        self.assertEqual(result["summary"]["unique"], sum(query["verdict"] == "unique" for query in result["queries"]))

    def test_single_queries_have_the_same_keys_as_tracked_ones(self):
        log = self.head("two.log", 2)
        single = self.json("localize", self.map, log)["queries"][0]
        tracked = self.json("localize", self.map, log, "--track")["queries"][0]
        shared = {"scan", "verdict", "reason", "confidence", "points", "time_us", "places", "hypotheses"}
        self.assertLessEqual(shared, set(single) & set(tracked))
        self.assertEqual(set(single["hypotheses"][0]), set(tracked["hypotheses"][0]))

    def test_a_scan_without_readings_in_the_middle_does_not_end_it(self):
        lines = scan_lines(self.head("blind.log", 30))
        lines[20][READINGS] = ["81.83"] * 360
        result = self.json("localize", self.map, write_lines(self.work / "blind.log", lines), "--track")
        self.assertEqual(result["queries"][20]["points"], 0)
        self.assertTrue(self.is_right(result["queries"][25], 25))

    def test_a_log_without_odometry_is_followed_by_the_scans_alone(self):
        lines = [["RAWLASER1", "0", "-1.570796", "3.141593", "0.008726646", "30", "0.01", "0", "360"] + line[READINGS] +
                 ["0", line[-3], "host", line[-1]] for line in scan_lines(self.head("raw.log", 30))]
        log = write_lines(self.work / "raw.log", lines)
        result = self.json("localize", self.map, log, "--track")
        self.assertEqual(result["odometry"], "none")
        self.assertGreater(result["summary"]["unique"], 10)
        done = run("localize", self.map, log, "--join", 4)
        self.assertEqual(done.returncode, 2)
        self.assertIn("odometry", done.stderr)

    def test_a_kidnapped_robot_is_found_again(self):
        lines = scan_lines(self.drive)
        self.assertGreater(len(lines), 160)
        def moved(line, before, after):  # poses of the line, as if `before` had been read where `after` was
            for at in (LASER_POSE, ROBOT_POSE):
                line[at] = map(str, compose(compose(before, inverse(after)), pose_of(line, at)))
            return line
        here, there = pose_of(lines[19], ROBOT_POSE), pose_of(lines[120], ROBOT_POSE)
        away = [moved(list(line), here, there) for line in lines[120:160]]
        result = self.json("localize", self.map, write_lines(self.work / "kidnapped.log", lines[:20] + away), "--track")
        self.assertTrue(self.is_right(result["queries"][19], 19))
        right = [self.is_right(result["queries"][20 + i], 120 + i) for i in range(40)]
        self.assertFalse(right[0])
        self.assertTrue(right[-1])
        self.assertGreater(sum(right), 20)
        self.assertGreaterEqual(result["summary"]["injections"], 2)

    def test_options_that_make_no_sense_together_are_refused(self):
        for extra in (("--scan", 1), ("--every", 2), ("--join", 3), ("--method", "papers"), ("--svg", "x.svg")):
            self.assertEqual(run("localize", self.map, self.drive, "--track", *extra).returncode, 1, extra)
        self.assertEqual(run("localize", self.map, self.drive, "--join", 3, "--method", "papers").returncode, 1)

    def test_joined_scans_have_more_points_and_say_so(self):
        log = self.head("joined.log", 12)
        alone = self.json("localize", self.map, log, "--scan", 11)
        joined = self.json("localize", self.map, log, "--scan", 11, "--join", 8)
        self.assertNotIn("join", alone)
        self.assertEqual((joined["join"], joined["odometry"]), (8, "own"))
        self.assertGreater(joined["queries"][0]["points"], alone["queries"][0]["points"])
        best = joined["queries"][0]["hypotheses"][0]
        self.assertLess(math.hypot(best["x"] - self.truth[11][0], best["y"] - self.truth[11][1]), 0.8)

    def test_bench_tracking_keeps_its_contract(self):
        out = self.work / "bench"
        result = self.json("bench", "tracking", self.log, "--drives-log", self.log, "--foreign", self.log, "--drives", 2,
                           "--length", 3, "--uniform-particles", 500, "-o", out)
        self.assertEqual(json.loads((out / "tracking.json").read_text())["summaries"], result["summaries"])
        kinds = {(summary["kind"], summary["initialisation"], summary["criterion"]) for summary in result["summaries"]}
        for kind in ("known", "foreign"):
            self.assertLessEqual({(kind, "hypotheses", "verdict"), (kind, "uniform", "verdict"), (kind, "uniform", "spread")},
                                 kinds)
        with open(out / "steps.csv", encoding="utf-8") as file:
            steps = list(csv.DictReader(file))
        for summary in result["summaries"]:
            if summary["criterion"] != "verdict":
                continue
            own = [step for step in steps
                   if (step["kind"], step["initialisation"]) == (summary["kind"], summary["initialisation"])]
            right = sum(step["verdict"] == "unique" and step["agrees"] == "1" for step in own)
            self.assertEqual(summary["right_scans"]["hits"], right)
            self.assertEqual(summary["right_scans"]["total"], len(own))
        with open(out / "drives.csv", encoding="utf-8") as file:
            self.assertEqual(len({row["drive"] for row in csv.DictReader(file)}),
                             sum(summary["drives"] for summary in result["summaries"] if summary["criterion"] == "verdict"))

    def test_bench_tracking_needs_true_poses(self):
        done = run("bench", "tracking", self.drive)
        self.assertEqual(done.returncode, 2)
        self.assertIn("poses", done.stderr)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
