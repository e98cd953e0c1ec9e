#!/usr/bin/env python3
"""`flirt slam` from outside: sessions that join an earlier map, windows, motions that cannot be seen.

usage: slam_test.py FLIRT_PROGRAM
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([FLIRT, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)


def ok(*arguments: object) -> subprocess.CompletedProcess:
    done = run(*arguments)
    assert done.returncode == 0, f"{arguments}\n{done.stdout}\n{done.stderr}"
    return done


def rows(path: pathlib.Path) -> list[list[str]]:
    return [line.split() for line in path.read_text().splitlines()]


class SlamSessions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        for name, seed, building in (("first", 3, 1), ("second", 8, 1), ("third", 21, 1), ("foreign", 5, 9)):
            ok("simulate", "-o", cls.work / f"{name}.log", "--truth", cls.work / f"{name}.tum", "--rounds", 1, "--seed", seed, "--office-area",
               400, "--office-seed", building, "--quiet")
        cls.earlier = cls.work / "earlier"
        ok("slam", cls.work / "first.log", "-o", cls.earlier, "--quiet")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def errors(self, folder: pathlib.Path, *sessions: str) -> dict:
        """ATE of the joint trajectory: where the sessions lie to each other counts."""
        found = rows(folder / "trajectory.tum")
        true = [row for session in sessions for row in rows(self.work / f"{session}.tum")]
        self.assertEqual(len(found), len(true))
        for name, poses in (("found", found), ("true", true)):  # the sessions' stamps are the same: count on
            (self.work / f"{name}.tum").write_text("".join(" ".join([str(i), *row[1:]]) + "\n" for i, row in enumerate(poses)))
        return json.loads(ok("evaluate", self.work / "found.tum", "--truth", self.work / "true.tum", "--json", "-").stdout)["ate"]

    def test_a_second_and_a_third_session_join_by_localization_alone(self):
        self.assertGreater(math.dist(*[[float(v) for v in rows(self.work / f"{name}.tum")[0][1:3]] for name in ("first", "second")]), 3,
                           "the sessions begin at different places")
        joint = self.work / "joint"
        resumed = json.loads(ok("slam", self.work / "second.log", "-o", joint, "--resume", self.earlier, "--json", "-").stdout)["resumed"]
        self.assertEqual(resumed["earlier_scans"], len(rows(self.work / "first.tum")))
        self.assertGreaterEqual(resumed["agreeing"], 10)
        error = self.errors(joint, "first", "second")
        self.assertLess(error["translation_m"]["rmse"], 0.03)
        self.assertLess(error["translation_m"]["max"], 0.15)
        self.assertLess(error["rotation_deg"]["rmse"], 0.5)
        self.assertEqual(rows(joint / "session.tum"), rows(joint / "trajectory.tum")[resumed["earlier_scans"]:])
        # Joined without odometry, and into the same folder.
        ok("slam", self.work / "third.log", "-o", joint, "--resume", joint, "--no-odometry", "--quiet")
        self.assertLess(self.errors(joint, "first", "second", "third")["translation_m"]["rmse"], 0.03)

    def test_another_building_is_not_joined(self):
        out = self.work / "not-made"
        done = run("slam", self.work / "foreign.log", "-o", out, "--resume", self.earlier, "--json", self.work / "answer.json")
        self.assertEqual(done.returncode, 4)
        self.assertIn("not found in the map of", done.stderr)
        resumed = json.loads((self.work / "answer.json").read_text())["resumed"]
        self.assertEqual(resumed["agreeing"], 0)
        self.assertEqual(resumed["earlier_scans"], len(rows(self.work / "first.tum")))
        self.assertGreater(resumed["queries"], 10)
        self.assertFalse(out.exists())

    def test_only_a_map_of_flirt_slam_can_be_resumed(self):
        log, out = self.work / "second.log", self.work / "not-made"
        for folder, code in ((self.work / "no-such-folder", 2), (self.work, 2)):
            self.assertEqual(run("slam", log, "-o", out, "--resume", folder).returncode, code)
        mixed = self.work / "mixed"
        mixed.mkdir()
        for file in self.earlier.iterdir():
            (mixed / file.name).write_bytes(file.read_bytes())
        (mixed / "trajectory.tum").write_text("\n".join(" ".join(row) for row in rows(mixed / "trajectory.tum")[:-1]) + "\n")
        done = run("slam", log, "-o", out, "--resume", mixed)
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected one map of flirt slam", done.stderr)
        done = run("slam", log, "-o", out, "--resume", self.earlier, "--window", 20)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--window", done.stderr)
        self.assertFalse(out.exists())

    def test_the_number_of_threads_changes_nothing(self):
        for threads in (1, 2):
            ok("slam", self.work / "second.log", "-o", self.work / f"threads-{threads}", "--threads", threads, "--quiet")
        for file in ("trajectory.tum", "graph.g2o", "map.pgm", "map.flirt"):
            self.assertEqual((self.work / "threads-1" / file).read_bytes(), (self.work / "threads-2" / file).read_bytes(), file)

    def test_a_window_closes_no_loops_and_needs_no_odometry(self):
        out = self.work / "window"
        summary = json.loads(ok("slam", self.work / "first.log", "-o", out, "--window", 20, "--json", "-").stdout)
        self.assertEqual((summary["odometry"], summary["closures"], summary["loop_edges"]), ("ignored", 0, 0))
        self.assertLess(self.errors(out, "first")["translation_m"]["rmse"], 0.5)

    def test_motion_along_a_bare_corridor_is_said_not_to_be_seen(self):
        log = self.work / "corridor.log"
        ok("simulate", "-o", log, "--truth", self.work / "corridor.tum", "--plan", "tunnel", "--people", 0, "--rounds", 1, "--lidar-range-max", 8,
           "--quiet")
        done = ok("slam", log, "-o", self.work / "corridor", "--no-odometry")
        unseen = json.loads((self.work / "corridor" / "summary.json").read_text())["unobservable"]
        self.assertGreater(unseen["count"], 20)
        self.assertEqual(len(unseen["scans"]), unseen["count"])
        self.assertIn(f"{unseen['count']} motions could not be seen", done.stdout)
        self.assertIn("could not be seen in some direction", (self.work / "corridor" / "report.html").read_text())
        # Edges of such motions say how little is known: less than 0.1 m in their least known direction.
        least = {}
        for row in rows(self.work / "corridor" / "graph.g2o"):
            if row[0] == "EDGE_SE2" and int(row[2]) == int(row[1]) + 1:
                xx, xy, _, yy = map(float, row[6:10])
                least[int(row[2])] = (xx + yy) / 2 - math.hypot((xx - yy) / 2, xy)
        seen = sorted(value for scan, value in least.items() if scan not in unseen["scans"])
        hidden = sorted(least[scan] for scan in unseen["scans"])
        self.assertLess(hidden[-1], 100)
        self.assertGreater(seen[len(seen) // 2], 100)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
