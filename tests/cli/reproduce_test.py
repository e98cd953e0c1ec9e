#!/usr/bin/env python3
"""scripts/reproduce in its smallest form, on a simulated building.

usage: reproduce_test.py FLIRT_PROGRAM SOURCE_FOLDER
"""
import csv
import html.parser
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""
SOURCE = pathlib.Path()


class OutsideLinks(html.parser.HTMLParser):
    """Everything in a page that would be fetched from elsewhere."""

    def __init__(self):
        super().__init__()
        self.found: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href", "xlink:href") and not value.startswith(("#", "data:")):
                self.found.append(value)
            if name == "id":
                self.ids.append(value)


class Reproduce(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.work = pathlib.Path(self.folder.name)

    def rows(self, file: pathlib.Path) -> list[dict]:
        with file.open() as lines:
            return list(csv.DictReader(lines))

    def test_reproduce_writes_one_page_without_outside_parts(self):
        out = self.work / "reproduction"
        done = subprocess.run([sys.executable, SOURCE / "scripts" / "reproduce", "--smallest", "--simulated", "--program", FLIRT, "--out", out],
                              capture_output=True, text=True, check=False, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = (out / "report.html").read_text()
        page = OutsideLinks()
        page.feed(text)
        self.assertEqual(page.found, [])
        self.assertEqual(len(page.ids), len(set(page.ids)))
        self.assertIn("No real logs were given", text)
        for experiment in ("P1 Fig. 1–4", "P2 Fig. 6", "P2 Fig. 7", "P2 Fig. 8, Table I", "P1 Fig. 6", "P1 Fig. 7", "P1 Table 2", "P1 Fig. 9", "the arena"):
            self.assertIn(experiment, text)
        for name in ("figure-2", "detectors-summary", "descriptors", "table-1", "table-2", "bench-slam", "crowds"):
            self.assertEqual(len(self.rows(out / "tables" / f"{name}.csv")), len(json.loads((out / "tables" / f"{name}.json").read_text())))
        figure_2 = self.rows(out / "tables" / "figure-2.csv")
        self.assertEqual([row["here: found on scales"] for row in figure_2], ["5", "1, 2, 3, 4, 5", "1, 2, 3, 4, 5", "1, 2", "none"])

    def test_reproduce_refuses_a_folder_that_is_not_there(self):
        done = subprocess.run([sys.executable, SOURCE / "scripts" / "reproduce", "--program", FLIRT, self.work / "nowhere", "--out",
                               self.work / "not-made"], capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertFalse((self.work / "not-made").exists())


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    SOURCE = pathlib.Path(sys.argv.pop(1))
    unittest.main()
