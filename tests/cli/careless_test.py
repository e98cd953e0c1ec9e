#!/usr/bin/env python3
"""What careless users do: options that say nothing, numbers that are none, files that are something else.

usage: careless_test.py FLIRT_PROGRAM
"""
import gzip
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

FLIRT = ""


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([FLIRT, *arguments], capture_output=True, check=False, timeout=300)


def flaser(pose: str, odometry: str, ranges: str = "4 2.0 2.0 2.0 2.0", stamp: float = 1) -> str:
    return f"FLASER {ranges} {pose} {odometry} {stamp} host {stamp}\n"


class Careless(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "room.log"
        done = run("simulate", "-o", cls.log, "--log-poses", "both", "--rounds", "1", "--office-area", "200",
                   "--drive-round-length", "30", "--quiet")
        assert done.returncode == 0, done.stderr
        cls.map = cls.work / "room.flirt"
        assert run("map", cls.log, "-o", cls.map, "--quiet").returncode == 0

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def file(self, name: str, text: str) -> pathlib.Path:
        path = self.work / name
        path.write_text(text, encoding="utf-8")
        return path

    def refused(self, code: int, message: str, *arguments: object) -> None:
        done = run(*arguments)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stderr}")
        self.assertIn(message, done.stderr.decode())
        self.assertEqual(done.stdout, b"", "nothing is printed by a command that failed")

    def test_numbers_are_what_they_should_be(self):
        self.refused(1, "0 or more, found -1", "info", self.log, "--seed", "-1")
        self.refused(1, "0 or more, found -1", "detect", self.log, "--scan", "-1")
        self.refused(1, "0 or more, found -5", "localize", self.map, self.log, "--hypotheses", "-5")
        self.refused(1, "finite number, found nan", "evaluate", self.log, "--truth", self.log, "--rpe-path", "nan")
        self.refused(1, "finite number, found nan", "info", self.log, "--range-max", "nan")
        self.refused(1, "--largest-dense: expected a number in range, 0 to 1e+12, found 'nan'", "localize", self.map, self.log,
                     "--largest-dense", "nan")
        self.refused(1, "--people", "simulate", "-o", self.work / "x.log", "--people", "100000000")

        huge = "9" * 23
        self.refused(1, f"--seed: expected a number of up to 2^64 - 1, found {huge}", "info", self.log, "--seed", huge)
        self.refused(1, f"--scan: expected a number of up to 2^64 - 1, found {huge}", "detect", self.log, "--scan", huge)
        self.refused(1, "above 0, found -1", "info", self.log, "--range-max", "-1")
        self.refused(1, "0 or more, found -1", "evaluate", self.log, "--truth", self.log, "--stamp-tolerance", "-1")
        for wrong in ("0", "-1"):
            self.refused(1, "--resolution", "simulate", "-o", self.work / "x.log", "--plan", "x.png", "--resolution", wrong)
        for option in ("--long", "--starts"):
            self.refused(1, option, "bench", "slam", "-o", self.work / "none", "--dynamic", option, "1000000000")

    def test_scales_that_no_scan_has_room_for_are_refused(self):
        for detector in ("curvature", "range", "normal-edge", "normal-blob"):
            scales = [f"--{detector}-scale-count", "12", f"--{detector}-scale-step", "10"]
            for command in (["detect", self.log, "--scan", "0"], ["map", self.log, "-o", self.work / "scales.flirt"]):
                self.refused(1, f"--detector {detector}: scale_base", *command, "--detector", detector, *scales)
        self.assertFalse((self.work / "scales.flirt").exists())

    def test_options_that_would_do_nothing_are_refused(self):
        out = self.work / "idle.flirt"
        self.refused(1, "--grid-spacing: expected only with a grid map", "map", self.log, "-o", out, "--grid-spacing", "1")
        self.refused(1, "--range-scale-count: expected only with --detector range", "detect", self.log,
                     "--range-scale-count", "3")
        self.refused(1, "--shape-context-radius: expected only with --descriptor shape-context", "map", self.log, "-o", out,
                     "--shape-context-radius", "1")
        config = self.file("range.toml", "[range]\nscale_count = 3\n")
        self.refused(2, f"flirt: {config}:2: --range-scale-count: expected only with", "detect", self.log, "--config", config)
        self.assertEqual(run("detect", self.log, "--scan", "0", "--detector", "range", "--config", config).returncode, 0)
        for first, second in (("--people", "--people-count"), ("--rounds", "--drive-rounds")):
            self.refused(1, second, "simulate", "-o", self.work / "x.log", first, "1", second, "2")
        self.refused(1, "--slam-front-end", "slam", self.log, "-o", self.work / "x", "--front-end", "auto", "--slam-front-end",
                     "icp")
        self.refused(1, "--svg", "detect", self.log, "--keypoint", "3")
        self.refused(1, "--svg", "simulate", "-o", self.work / "x.log", "--svg-scan", "3")
        self.refused(1, "--ablation", "bench", "localization", self.log, "--protocol", "revisit", "--variants", "full")

    def test_curves_from_three_inliers_on_need_matches_of_three(self):
        bench = ["bench", "localization", self.log, "--every", "40", "--method", "papers", "--ransac-min-inliers"]
        self.refused(1, "--ransac-min-inliers: expected up to 3 with --protocol paper, found 6", *bench, "6")
        self.assertEqual(run(*bench, "3", "--quiet").returncode, 0)
        self.assertEqual(run(*bench, "6", "--protocol", "revisit", "--quiet").returncode, 0)

    def test_parameters_of_another_plan_are_refused(self):
        out = self.work / "plan.log"
        segments = self.file("plan.txt", "0,0,9,0\n9,0,9,9\n9,9,0,9\n0,9,0,0\n")
        for plan, flag in (("corridors", "--office-area"), ("office", "--tunnel-length"), (segments, "--office-seed"),
                           ("tunnel", "--station-length"), ("station", "--corridors-length"),
                           ("corridors", "--warehouse-length"), ("warehouse", "--office-area")):
            self.refused(1, f"{flag}: expected only with --plan {flag.split('-')[2]}", "simulate", "-o", out, "--plan", plan,
                         flag, "300")
        config = self.file("office.toml", "[drive]\nrounds = 1\n[office]\narea = 300\n")
        self.refused(2, f"flirt: {config}:4: --office-area: expected only with --plan office", "simulate", "-o", out,
                     "--plan", "tunnel", "--config", config)
        self.assertFalse(out.exists())

    def test_plans_in_which_no_robot_can_drive_are_named(self):
        wide = self.file("wide.txt", "0,0,9,0\n9,0,9,9\n9,9,0,9\n0,1e9,0,0\n")
        self.refused(2, f"flirt: {wide}: expected a plan of up to 10 km x 10 km", "simulate", "-o", self.work / "w.log",
                     "--plan", wide)
        tiny = self.file("tiny.txt", "0,0,0.1,0\n")
        self.refused(2, f"flirt: {tiny}: expected room for a robot", "simulate", "-o", self.work / "w.log", "--plan", tiny)

    def test_a_window_is_read_like_every_number(self):
        for window in ("3", "0x3"):
            out = self.work / window
            self.assertEqual(run("slam", self.log, "-o", out, "--window", window, "--every", "5").returncode, 0)
            summary = json.loads((out / "summary.json").read_text())
            self.assertEqual((summary["odometry"], summary["seed"]), ("ignored", 0))

    def test_a_seed_of_one_method_wins_over_that_of_the_command(self):
        result = run("localize", self.map, self.log, "--scan", "0", "--method", "papers", "--ransac-seed", "7", "--seed", "3",
                     "--json", "-")
        self.assertEqual(json.loads(result.stdout)["params"]["ransac"]["seed"], 7)
        result = run("evaluate", self.log, "--truth", self.log, "--quality-seed", "7", "--seed", "3", "--json", "-")
        self.assertEqual(json.loads(result.stdout)["params"]["quality"]["seed"], 7)
        result = run("evaluate", self.log, "--truth", self.log, "--seed", "3", "--json", "-")
        self.assertEqual(json.loads(result.stdout)["params"]["quality"]["seed"], 3)

    def test_a_seed_given_wins_over_that_of_a_file(self):
        config = self.file("seed.toml", "[ransac]\nseed = 5\n")
        commands = (["match", self.log, "--scan", "0", "--against", "1"],
                    ["localize", self.map, self.log, "--scan", "0"],
                    ["bench", "localization", self.log, "--every", "50"],
                    ["bench", "tracking", self.log, "--drives", "1", "--length", "1"],
                    ["bench", "buildings", "--queries", "1", "--office-area", "200", "--people", "0", "--fields-of-view", "180"],
                    ["bench", "arena", self.log, "--every", "100", "--detectors", "curvature", "--descriptors", "beta-grid",
                     "--matchers", "ransac"])
        for command in commands:
            for flags, expected in (([], 5), (["--seed", "3"], 3), (["--seed", "3", "--ransac-seed", "7"], 7)):
                done = run(*command, "--config", config, *flags, "--json", "-")
                self.assertIn(done.returncode, (0, 4), done.stderr)
                result = json.loads(done.stdout)
                self.assertEqual(result["params"]["ransac"]["seed"], expected, command)
                if command[0] != "match":
                    self.assertEqual(result["seed"], 3 if flags else 0, command)

    def test_a_file_can_hold_every_parameter_of_localization(self):
        config = self.file("legs.toml", "[localize]\nfew_legs = 0.2\nlargest_dense = 50\n")
        done = run("localize", self.map, self.log, "--scan", "0", "--config", config, "--few-legs", "0.3", "--json", "-")
        self.assertEqual(json.loads(done.stdout)["params"]["localize"], {"largest_dense": 50.0, "few_legs": 0.3})

    def test_benches_refuse_what_would_end_badly(self):
        graph = self.file("two.graph", "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 1 0 1 1 0 0\n")
        self.refused(1, "less than the 2 nodes", "bench", "optimizers", graph, "--optimize-fixed-node", "2")
        self.refused(1, "each name once, found 'a' again", "bench", "slam", "-o", self.work / "twice", "--log",
                     f"a={self.log}", "--log", f"a={self.log}")

    def test_a_config_file_is_read_by_every_command(self):
        missing = self.work / "missing.toml"
        empty = self.file("empty.toml", "")
        wrong = self.file("wrong.toml", "# hm\n[nonsense]\n")
        commands = (["info", self.log], ["detect", self.log], ["convert", self.log, self.work / "x.tum"],
                    ["evaluate", self.log, "--truth", self.log], ["bench", "detectors", self.log],
                    ["bench", "descriptors", self.log], ["bench", "ablation", self.log], ["bench", "speed"])
        for command in commands:
            self.refused(2, f"flirt: {missing}: expected a file", *command, "--config", missing)
            self.refused(2, f"flirt: {self.work}: expected a file, found a folder", *command, "--config", self.work)
            self.refused(2, f"flirt: {wrong}:2: expected", *command, "--config", wrong)
        self.assertEqual(run("info", self.log, "--config", empty).returncode, 0)

    def test_config_values_have_their_types(self):
        match = ["match", self.log, "--scan", "0", "--against", "1", "--json", "-", "--config"]
        for line in ("inlier_distance = '0.1'", "inlier_distance = true", "inlier_distance = [1]", "inlier_distance = nan",
                     "inlier_distance = inf", "min_inliers = 3.5", "min_inliers = -3", "min_inliers = 1979-05-27"):
            config = self.file("types.toml", f"[ransac]\n{line}\n")
            self.refused(2, f"flirt: {config}:2: --ransac-", *match, config)
        done = run(*match, self.file("types.toml", "[ransac]\nmin_inliers = 0x5\n[match]\ndistance = 'euclidean'\n"))
        self.assertEqual(json.loads(done.stdout)["params"]["ransac"]["min_inliers"], 5, done.stderr)

    def test_json_stands_whatever_bytes_are_in_it(self):
        good = flaser("0 0 0", "0 0 0").encode()
        strange = self.work.joinpath(os.fsdecode(b"stra\xffnge.log"))
        strange.write_bytes(good + b"FLASER \xff\xfe\n")
        done = run("info", strange, "--lenient", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout.decode("utf-8"))["lines"]["broken"], 1)

    def test_places_off_the_earth_are_refused(self):
        far = self.file("far.log", flaser("0 0 0", "0 0 0") + flaser("1e9 0 0", "0 0 0"))
        for command in (["info", far], ["map", far, "-o", self.work / "far.flirt"], ["slam", far, "-o", self.work / "far"],
                        ["evaluate", far, "--scans", far], ["localize", self.map, far]):
            self.refused(2, f"flirt: {far}:2: FLASER: expected a place within 10 000 km", *command)

    def test_scans_too_far_apart_for_one_map_leave_nothing_behind(self):
        jumps = self.file("jumps.log", "".join(
            flaser(f"{i % 2 * 1e6} 0 0", f"{i % 2 * 1e6} {i % 2 * 1e6} 0", stamp=i) for i in range(4)))
        out = self.work / "jumps"
        self.refused(2, f"flirt: {jumps}: expected scans near each other", "slam", jumps, "-o", out, "--front-end", "icp")
        self.assertFalse(out.exists())

    def test_a_map_of_more_than_a_million_cells_in_a_row_is_coarser(self):
        scan = " ".join(["180"] + [f"{2 + i // 20 % 3}" for i in range(180)])
        wide = self.file("wide.log", "".join(flaser(f"{3000 * i} 0 0", f"{3000 * i} 0 0", scan, i) for i in range(20)))
        out = self.work / "wide"
        done = run("slam", wide, "-o", out, "--quiet", "--front-end", "icp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({path.suffix for path in out.iterdir()},
                         {".tum", ".g2o", ".yaml", ".pgm", ".png", ".flirt", ".html", ".json"})
        resolution = re.search(r"resolution: ([\d.]+)", (out / "map.yaml").read_text())
        self.assertGreater(float(resolution[1]), 0.05)

    def test_a_log_that_never_ends_its_line_is_refused(self):
        bomb = self.work / "bomb.log.gz"
        with gzip.open(bomb, "wb") as file:
            for _ in range(66):
                file.write(bytes(1 << 20))
        self.refused(2, f"flirt: {bomb}:1: expected a line of up to 64 MB, found a longer one", "info", bomb)

    def test_broken_gzip_data_is_said_once(self):
        packed = bytearray(gzip.compress(self.log.read_bytes()))
        packed[-8] ^= 0xFF  # of the check sum
        broken = self.work / "broken.log.gz"
        broken.write_bytes(packed)
        done = run("info", broken)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.decode().count(str(broken)), 1, done.stderr)

    def test_files_that_cannot_be_written_come_before_the_work(self):
        out = self.work / "blocked"
        (out / "map.png").mkdir(parents=True)
        self.refused(2, f"flirt: {out / 'map.png'}: expected a file to write, found a folder", "slam", self.log, "-o", out)
        self.assertEqual([path.name for path in out.iterdir()], ["map.png"])
        log = self.work / "unwritten.log"
        self.refused(2, "flirt: /nonexistent/t.tum: expected to write", "simulate", "-o", log, "--truth", "/nonexistent/t.tum")
        for flag in ("--truth", "--svg"):
            self.refused(1, f"{log}: expected a file of its own", "simulate", "-o", log, flag, log)
        self.assertFalse(log.exists())

    def test_errors_of_maps_name_the_log(self):
        scan = " ".join(["180"] + [f"{2 + i // 20 % 3}" for i in range(180)])
        far = self.file("20km-apart.log", "".join(
            flaser(f"{i * 10000} {i % 2 * 20000} 0", "0 0 0", scan, i) for i in range(3)))
        for command in (["localization", far], ["tracking", far], ["arena", far], ["ablation", far],
                        ["speed", "--sections", "stages", "--log", far]):
            self.refused(2, f"flirt: {far}: expected scans near each other", "bench", *command)

    def test_scans_far_apart_make_a_map_or_are_refused(self):
        scan = " ".join(["180"] + [f"{2 + i // 20 % 3}" for i in range(180)])
        for kilometres, code in ((4, 0), (20, 2)):
            log = self.file(f"{kilometres}km.log", "".join(
                flaser(f"{i * kilometres * 500} {i % 2 * kilometres * 1000} 0", "0 0 0", scan, i) for i in range(3)))
            out = self.work / f"{kilometres}km.flirt"
            done = run("map", log, "-o", out, "--quiet")
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(out.exists(), code == 0)
            if code == 0:
                self.assertEqual(run("localize", out, log, "--scan", "1", "--quiet").returncode, 0)
            else:
                self.assertIn(f"flirt: {log}: expected scans near each other, in a box of up to 100 km²", done.stderr.decode())

    def test_nothing_to_compare_is_no_perfect_score(self):
        elsewhen = self.file("elsewhen.rel", "1e6 2e6 1 0 0 0 0 0\n")
        late = self.file("late.tum", "1e6 0 0 0 0 0 0 1\n")
        for code, name, *arguments in ((2, elsewhen, self.log, "--relations", elsewhen), (2, self.log, late, "--scans", self.log),
                                       (2, self.log, self.log, "--truth", late)):
            done = run("evaluate", *arguments, "--quiet")
            self.assertEqual(done.returncode, code)
            self.assertIn(f"flirt: {name}: expected", done.stderr.decode())
        first = run("info", self.log, "--json", "-")
        stamp = json.loads(first.stdout)["stamps"]["first"]
        done = run("evaluate", self.log, "--truth", self.file("one.tum", f"{stamp!r} 0 0 0 0 0 0 1\n"))
        self.assertIn(b"nothing to compare", done.stdout)
        done = run("evaluate", self.file("one.tum", f"{stamp!r} 0 0 0 0 0 0 1\n"), "--truth", self.log, "--scans", self.log,
                   "--json", "-")
        result = json.loads(done.stdout)
        self.assertEqual((result["rpe"]["translation_m"]["rmse"], result["rpe"]["translation_m"]["count"]), (None, 0))
        self.assertIsNone(result["map_quality"]["point_to_line_rms_m"])

    def test_what_a_bench_varies_itself_is_no_option(self):
        self.refused(1, "--optimize-backend", "bench", "optimizers", self.log, "--optimize-backend", "toro")
        self.refused(1, "--office-seed", "bench", "buildings", "--office-seed", "3")
        self.refused(1, "--office-changed", "bench", "buildings", "--office-changed", "0.3")
        self.refused(1, "--changed", "bench", "buildings", "plan.yaml", "--changed", "30")
        self.refused(1, "--lidar-field-of-view", "bench", "buildings", "--lidar-field-of-view", "3")

    def test_a_log_may_come_through_a_pipe(self):
        with open(self.log, "rb") as log:
            text = log.read()
        done = subprocess.run([FLIRT, "info", "/dev/stdin", "--json", "-"], input=text, capture_output=True, check=False,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole, piped = json.loads(run("info", self.log, "--json", "-").stdout), json.loads(done.stdout)
        self.assertEqual({**piped, "log": 0}, {**whole, "log": 0})
        done = subprocess.run([FLIRT, "convert", "/dev/stdin", self.work / "piped.tum"], input=text, capture_output=True,
                              check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"/dev/stdin: expected a regular file, found a pipe", done.stderr)

    def test_a_configuration_may_come_through_a_pipe(self):
        done = subprocess.run([FLIRT, "detect", self.log, "--scan", "0", "--config", "/dev/stdin"], input=b"[nonsense]\n",
                              capture_output=True, check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"/dev/stdin:1: expected parameters of this command", done.stderr)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_output_that_does_not_arrive_is_an_error(self):
        for arguments in (["info", self.log], ["info", self.log, "--json", "-"], ["localize", self.map, self.log]):
            with open("/dev/full", "wb") as full:
                done = subprocess.run([FLIRT, *arguments], stdout=full, stderr=subprocess.PIPE, check=False, timeout=300)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(b"stdout: expected", done.stderr)

    def test_a_picture_that_cannot_be_drawn_comes_before_all_output(self):
        out = self.work / "unwritten.jsonl"
        self.refused(1, "--keypoint", "detect", self.log, "--svg", self.work / "x.svg", "--keypoint", "9999", "--json", out)
        self.assertFalse(out.exists())
        self.refused(1, "--svg-scan", "simulate", "-o", self.work / "x.log", "--office-area", "200", "--svg",
                     self.work / "x.svg", "--svg-scan", "999999")
        self.assertFalse((self.work / "x.log").exists())


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
