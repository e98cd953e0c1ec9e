#!/usr/bin/env python3
"""flirt bench arena, and --rivals of flirt bench detectors, from outside.

usage: arena_test.py FLIRT_PROGRAM
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


def without_times(rows: list[dict]) -> list[dict]:
    return [{key: value for key, value in row.items() if not key.endswith("_us")} for row in rows]


class Arena(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "office.log"
        done = run("simulate", "-o", cls.log, "--log-poses", "truth", "--rounds", 1, "--office-area", 200, "--seed", 3, "--drive-round-length",
                   25, "--quiet")
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def arena(self, *arguments: object) -> subprocess.CompletedProcess:
        return run("bench", "arena", self.log, "--every", 20, "--detectors", "falko", "--descriptors", "cgh,none", *arguments)

    def test_every_combination_has_a_line_and_ours_comes_first(self):
        out = self.work / "results"
        done = self.arena("-o", out, "--json", self.work / "a.json", "--threads", 1)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = list(csv.DictReader((out / "contenders.csv").read_text().splitlines()))
        self.assertEqual([(row["detector"], row["descriptor"], row["matcher"]) for row in rows],
                         [("curvature", "beta-grid", "ransac"), ("falko", "cgh", "ransac"), ("falko", "cgh", "clique"), ("falko", "cgh", "hough"),
                          ("falko", "none", "clique"), ("falko", "none", "hough"), ("none", "none", "beams")])
        self.assertGreater(float(rows[0]["paper"]), 0.8)
        for row in rows:
            self.assertLessEqual(float(row["paper_low"]), float(row["paper"]))
            self.assertGreaterEqual(float(row["paper_high"]), float(row["paper"]))
        self.assertEqual(float(rows[0]["paper_p"]), 1.0)
        for name in ("report.html", "arena.json", "arena-paper.svg", "arena-revisit.svg", "shortlists.csv", "precision-recall.csv"):
            self.assertGreater((out / name).stat().st_size, 0, name)

        done = self.arena("--json", self.work / "b.json", "--threads", 3, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        first, second = (json.loads((self.work / name).read_text()) for name in ("a.json", "b.json"))
        for table in ("contenders", "shortlists"):
            self.assertEqual(without_times(first[table]), without_times(second[table]))

    def test_wrong_input_is_named_and_leaves_nothing(self):
        out = self.work / "nothing"
        done = run("bench", "arena", self.work / "missing.log", "-o", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("missing.log", done.stderr)
        self.assertFalse(out.exists())
        done = run("bench", "arena", self.log, "--detectors", "sift", "-o", out)
        self.assertEqual(done.returncode, 1)
        self.assertIn("sift", done.stderr)
        self.assertFalse(out.exists())

    def test_scans_without_any_return_are_answered_by_nobody(self):
        log = self.work / "empty.log"
        readings = " ".join(["81.91"] * 180)
        log.write_text("".join(f"FLASER 180 {readings} {i}.0 0 0 {i}.0 0 0 {i} host {i}\n" for i in range(4)))
        done = run("bench", "arena", log, "--json", "-", "--quiet", "--detectors", "falko,oc", "--descriptors", "bsc,cgh,none")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual(result["queries"], 4)
        for row in result["contenders"]:
            self.assertEqual(row["paper"], 0, row)
            self.assertEqual(row["keypoints"], 0, row)

    def test_rivals_join_the_bench_of_detectors(self):
        arguments = ("bench", "detectors", self.log, "--locations", 1, "--partners", 1, "--json", "-", "--quiet")
        plain, rivals = run(*arguments), run(*arguments, "--rivals")
        self.assertEqual(rivals.returncode, 0, rivals.stderr)
        names = [{row["detector"] for row in json.loads(done.stdout)["summary"]} for done in (plain, rivals)]
        self.assertEqual(names[1] - names[0], {"falko", "falko-default", "falko-sparse", "oc"})


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
