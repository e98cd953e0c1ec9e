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
        done = run("bench", "speed", "--log", self.log, "--sections", section, "-o", out, "--json", "-", "--quiet", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(found[section], json.loads((out / "speed.json").read_text())[section])
        with open(out / f"speed-{section}.csv", encoding="utf-8") as table:
            self.assertEqual(len(list(csv.DictReader(table))), len(found[section]))
        self.assertIn("<svg", (out / "report.html").read_text())
        return found[section]

    def test_stages_are_timed_one_by_one(self):
        rows = self.rows("stages", "--queries", 6)
        stages = [row["stage"] for row in rows]
        for stage in ("detect", "describe"):
            self.assertTrue(any(stage in name for name in stages), stages)
        self.assertGreaterEqual(len(stages), 5)
        for row in rows:
            self.assertTrue(row["least"] <= row["median"] <= row["p95"], row)

    def test_area_of_the_map_is_shown_for_every_method(self):
        rows = self.rows("map-area", "--areas", "300", "--queries", 4)
        self.assertEqual(sorted(row["method"] for row in rows), ["auto", "dense", "features"])


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
