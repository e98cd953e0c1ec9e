#!/usr/bin/env python3
"""`flirt map` on ROS grid maps, from outside.

usage: grid_map_test.py FLIRT_PROGRAM
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""
SIDE = 160  # pixels of 0.05 m


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([FLIRT, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)


def room() -> bytearray:
    """An unsymmetric room of 8 m × 8 m, rows from the top: 0 occupied, 254 free."""
    pixels = bytearray([254]) * (SIDE * SIDE)

    def fill(left: int, top: int, right: int, bottom: int) -> None:
        for row in range(top, bottom):
            pixels[row * SIDE + left:row * SIDE + right] = bytes(right - left)

    for wall in ((0, 0, SIDE, 2), (0, SIDE - 2, SIDE, SIDE), (0, 0, 2, SIDE), (SIDE - 2, 0, SIDE, SIDE)):
        fill(*wall)
    for box in ((30, 40, 50, 48), (100, 20, 108, 60), (120, 110, 150, 118), (20, 120, 28, 128), (70, 130, 90, 134)):
        fill(*box)
    return pixels


class GridMap(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.yaml = self.write("room", room(), "")

    def write(self, name: str, pixels: bytes, more: str) -> pathlib.Path:
        (self.work / f"{name}.pgm").write_bytes(f"P5\n{SIDE} {SIDE}\n255\n".encode() + pixels)
        yaml = self.work / f"{name}.yaml"
        yaml.write_text(f"image: {name}.pgm\nresolution: 0.05\norigin: [-3.0, 2.0, 0.0]\n{more}")
        return yaml

    def mapped(self, yaml: pathlib.Path, *arguments: object) -> dict:
        done = run("map", yaml, "-o", yaml.with_suffix(".flirt"), "--json", "-", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def refused(self, code: int, *arguments: object) -> str:
        out = self.work / "refused.flirt"
        done = run("map", *arguments, "-o", out)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertFalse(out.exists())
        return done.stderr

    def test_scans_are_found_in_the_map(self):
        made = self.mapped(self.yaml)
        self.assertEqual(made["poses"], "virtual")
        self.assertGreater(made["map_scans"], 20)
        self.assertGreater(made["features"], 0)
        log = self.work / "drive.log"
        done = run("simulate", "-o", log, "--plan", self.yaml, "--log-poses", "truth", "--rounds", 1, "--seed", 2,
                   "--lidar-field-of-view", 2 * math.pi - 1e-4, "--lidar-mount-x", 0, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = run("localize", self.yaml.with_suffix(".flirt"), log, "--scan", 10, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        query = json.loads(done.stdout)["queries"][0]
        self.assertEqual(query["verdict"], "unique")
        truth = [line.split() for line in (self.work / "drive.log.truth.tum").read_text().splitlines()
                 if not line.startswith("#")][10]
        best = query["hypotheses"][0]
        self.assertLess(math.hypot(best["x"] - float(truth[1]), best["y"] - float(truth[2])), 0.05)

    def test_flags_of_the_virtual_scans_count(self):
        self.assertLess(self.mapped(self.yaml, "--grid-spacing", 2)["map_scans"], self.mapped(self.yaml)["map_scans"])

    def test_variances_are_kept_when_asked_for(self):
        self.assertGreater(self.mapped(self.yaml, "--variances")["bytes"], self.mapped(self.yaml)["bytes"])

    def test_broken_yaml_is_bad_input_with_file_and_line(self):
        self.yaml.write_text("image: room.pgm\nresolution: much\norigin: [0, 0, 0]\n")
        self.assertTrue(self.refused(2, self.yaml).startswith(f"flirt: {self.yaml}:2: "))

    def test_missing_image_is_bad_input_with_its_name(self):
        (self.work / "room.pgm").unlink()
        self.assertIn("room.pgm", self.refused(2, self.yaml))

    def test_grid_without_free_space_is_bad_input_with_its_name(self):
        grey = self.write("grey", bytes([205]) * (SIDE * SIDE), "")
        self.assertTrue(self.refused(2, grey).startswith(f"flirt: {grey}: "))

    def test_wrong_use_exits_1(self):
        self.assertIn("YAML", self.refused(1, self.work / "room.pgm"))
        self.assertIn("--every", self.refused(1, self.yaml, "--every", 2))
        self.assertIn("spacing", self.refused(1, self.yaml, "--grid-spacing", 0))


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
