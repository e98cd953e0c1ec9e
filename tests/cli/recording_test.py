#!/usr/bin/env python3
"""Recordings of ROS from outside: a drive written as MCAP is told about, converted and mapped as the same drive in CARMEN.

usage: recording_test.py FLIRT_PROGRAM
"""
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""


def flirt(*arguments, code=0):
    run = subprocess.run([FLIRT, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == code, (arguments, run.returncode, run.stdout, run.stderr)
    return run


class Fields:
    """The fields of a ROS 2 message as bytes (CDR, little-endian)."""

    def __init__(self):
        self.bytes = b""

    def number(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.bytes += b"\0" * (-len(self.bytes) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, value):
        self.number("I", len(value) + 1)
        self.bytes += value.encode() + b"\0"
        return self

    def header(self, stamp, frame):
        return self.number("i", int(stamp)).number("I", round((stamp - int(stamp)) * 1e9)).text(frame)

    def whole(self):
        return b"\0\1\0\0" + self.bytes


def transform(stamp, parent, child, x, y, theta):
    fields = Fields().number("I", 1).header(stamp, parent).text(child)
    return fields.number("d", x, y, 0, 0, 0, math.sin(theta / 2), math.cos(theta / 2)).whole()


def sized(data, kind="I"):
    return struct.pack("<" + kind, len(data)) + data


def mcap(messages):
    """messages: (topic, type, bytes)."""
    def record(op, content):
        return bytes([op]) + sized(content, "Q")

    out = b"\x89MCAP0\r\n" + record(1, sized(b"ros2") + sized(b"test"))
    topics = {}
    for topic, kind, data in messages:
        if topic not in topics:
            topics[topic] = number = struct.pack("<H", len(topics) + 1)
            out += record(3, number + sized(kind.encode()) + sized(b"ros2msg") + sized(b""))
            out += record(4, number + number + sized(topic.encode()) + sized(b"cdr") + sized(b""))
        out += record(5, topics[topic] + struct.pack("<IQQ", 0, 0, 0) + data)
    return out + record(15, b"\0" * 4) + record(2, b"\0" * 20) + b"\x89MCAP0\r\n"


def carmen_scans(path):
    """(stamp, angle_min, step, range_max, ranges, odometry of the robot) of ROBOTLASER1 lines."""
    for line in path.read_text().splitlines():
        words = line.split()
        if not words or words[0] != "ROBOTLASER1":
            continue
        count = int(words[8])
        rest = words[9 + count:]
        rest = rest[1 + int(rest[0]):]
        yield (float(rest[11]), float(words[2]), float(words[4]), float(words[5]),
               [float(word) for word in words[9:9 + count]], [float(word) for word in rest[3:6]])


class Recording(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.log = cls.path / "drive.log"
        flirt("simulate", "-o", cls.log, "--office-area", 200, "--rounds", 1, "--seed", 3)
        messages = [("/tf_static", "tf2_msgs/msg/TFMessage", transform(0, "base_link", "laser", 0.1, 0, 0))]
        cls.count = 0
        for stamp, first, step, range_max, ranges, (x, y, theta) in carmen_scans(cls.log):
            fields = Fields().header(stamp, "laser")
            fields.number("f", first, first + step * (len(ranges) - 1), step, 0, 0, 0, range_max)
            fields.number("I", len(ranges)).number("f", *ranges).number("I", 0)
            messages.append(("/scan", "sensor_msgs/msg/LaserScan", fields.whole()))
            messages.append(("/tf", "tf2_msgs/msg/TFMessage", transform(stamp, "odom", "base_link", x, y, theta)))
            cls.count += 1
        messages.append(("/scan_back", "sensor_msgs/msg/LaserScan", fields.whole()))
        cls.recording = cls.path / "drive.mcap"
        cls.recording.write_bytes(mcap(messages))
        cls.messages = messages

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def info(self, path):
        flirt("info", path, "--json", self.path / "info.json", "--quiet")
        return json.loads((self.path / "info.json").read_text())

    def test_info_tells_topics_and_odometry(self):
        info = self.info(self.recording)
        self.assertEqual((info["format"], info["message"]), ("MCAP", "/scan"))
        self.assertEqual(info["scans"], self.count)
        self.assertEqual(info["lines"]["skipped"], {"/scan_back": 1})
        self.assertEqual(info["poses"]["source"], "odometry")
        self.assertIn("messages", flirt("info", self.recording).stdout)

    def test_convert_gives_the_log_that_was_recorded(self):
        flirt("convert", self.recording, self.path / "back.log")
        recorded, written = self.info(self.log), self.info(self.path / "back.log")
        for key in ("scans", "beams"):
            self.assertEqual(recorded[key], written[key])
        self.assertEqual(recorded["ranges"]["hits"], written["ranges"]["hits"])
        for one, other in zip(recorded["robot_from_sensor"], written["robot_from_sensor"], strict=True):
            self.assertAlmostEqual(one, other, places=9)
        self.assertAlmostEqual(recorded["odometry"]["path"], written["odometry"]["path"], places=3)

    def test_convert_picks_a_topic(self):
        flirt("convert", self.recording, self.path / "other.log", "--message", "/scan_back")
        self.assertEqual(self.info(self.path / "other.log")["scans"], 1)
        refused = flirt("convert", self.recording, self.path / "none.log", "--message", "/left", code=2)
        self.assertIn("expected scans on /left, found them on /scan, /scan_back", refused.stderr)
        self.assertFalse((self.path / "none.log").exists())

    def test_convert_says_that_odometry_of_some_scans_is_lost(self):
        moves = [message for message in self.messages if message[0] == "/tf"]
        missing = set(moves[self.count // 3:self.count // 2])
        partial, written = self.path / "partial.mcap", self.path / "partial.log"
        partial.write_bytes(mcap([message for message in self.messages if message not in missing]))
        with_odometry = self.info(partial)["odometry"]["count"]
        self.assertTrue(0 < with_odometry < self.count)
        self.assertIn(f"not in the new file: the odometry, which only {with_odometry} of {self.count} scans have",
                      flirt("convert", partial, written).stdout)
        self.assertEqual(self.info(written)["poses"]["source"], "none")

    def test_slam_maps_a_recording(self):
        for log, out in ((self.recording, "of-recording"), (self.log, "of-log")):
            flirt("slam", log, "-o", self.path / out, "--quiet")
        flirt("evaluate", self.path / "of-recording" / "trajectory.tum", "--truth", self.path / "of-log" / "trajectory.tum",
              "--json", self.path / "error.json", "--quiet")
        error = json.loads((self.path / "error.json").read_text())
        self.assertLess(error["ate"]["translation_m"]["rmse"], 0.01)

    def test_a_cut_recording_is_an_error_with_its_place(self):
        cut = self.path / "cut.mcap"
        cut.write_bytes(self.recording.read_bytes()[:100_000])
        self.assertRegex(flirt("info", cut, code=2).stderr, r"cut\.mcap: at byte \d+: expected")
        self.assertIn("1 broken message skipped", flirt("info", cut, "--lenient").stdout)

    def test_convert_saves_what_is_whole_of_a_cut_recording(self):
        cut = self.path / "died.mcap"
        cut.write_bytes(self.recording.read_bytes()[:100_000])
        saved = self.path / "saved.log"
        flirt("convert", cut, saved, code=2)
        self.assertFalse(saved.exists())
        self.assertIn("messages that are broken: 1", flirt("convert", cut, saved, "--lenient").stdout)
        self.assertGreater(self.info(saved)["scans"], 10)
        self.assertLess(self.info(saved)["scans"], self.count)

    def test_convert_refuses_what_would_do_nothing(self):
        self.assertIn("read, never written", flirt("convert", self.log, self.path / "x.mcap", code=1).stderr)
        self.assertFalse((self.path / "x.mcap").exists())
        flirt("convert", self.log, self.path / "poses.tum")
        refused = flirt("convert", self.path / "poses.tum", self.path / "x.g2o", "--lenient", code=1)
        self.assertIn("expected a log, found a tum file", refused.stderr)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
