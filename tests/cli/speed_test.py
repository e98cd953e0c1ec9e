#!/usr/bin/env python3
"""`flirt bench speed`, from outside.

usage: speed_test.py FLIRT_PROGRAM
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


class Speed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log = self.folder / "office.log"
        done = run("simulate", "-o", self.log, "--office-area", "300", "--rounds", "1", "--log-poses", "truth",
                   "--drive-scan-distance", "0.5", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)

    def rows(self, section: str, *arguments: object) -> list:
        out = self.folder / "out"
        done = run("bench", "speed", self.log, "--section", section, "-o", out, "--json", "-", "--quiet", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(found[section], json.loads((out / "speed.json").read_text())[section])
        with open(out / f"speed-{section}.csv", encoding="utf-8") as table:
            self.assertEqual(len(list(csv.DictReader(table))), len(found[section]))
        return found[section]

    def test_stages_are_timed_one_by_one(self):
        rows = self.rows("stages", "--queries", 6)
        self.assertEqual([row["stage"] for row in rows],
                         ["detect", "describe", "match query after query", "match a pair alone", "localize by papers",
                          "localize by auto"])
        for row in rows:
            self.assertGreater(row["median_us"], 0)
        self.assertLess(rows[2]["median_us"], rows[4]["median_us"])

    def test_maps_of_many_scans_grow_and_still_answer(self):
        rows = self.rows("map-scans", "--sizes", "100,200", "--queries", 5)
        self.assertEqual([row["map_scans"] for row in rows], [100] * 3 + [200] * 3)
        self.assertGreater(rows[3]["map_mb"], 1.8 * rows[0]["map_mb"])
        for row in rows:
            self.assertGreaterEqual(row["right"], 0.8)
        self.assertEqual([row["as_all_pairs"] for row in rows if row["method"] == "papers"], [1, 1])
        self.assertTrue((self.folder / "out/speed-map-scans.svg").read_text().startswith("<"))

    def test_area_of_the_map_is_shown_for_every_method(self):
        rows = self.rows("map-area", "--areas", "300", "--queries", 4)
        self.assertEqual(sorted(row["method"] for row in rows), ["auto", "dense", "features"])

    def test_a_log_that_is_not_there_is_said(self):
        missing = run("bench", "speed", self.folder / "none.log", "--section", "stages")
        self.assertEqual(missing.returncode, 2)
        self.assertIn("none.log", missing.stderr)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
