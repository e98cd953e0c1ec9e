#!/usr/bin/env python3
"""The program from outside: commands, exit codes, messages and the JSON contract.

usage: cli_test.py FLIRT_PROGRAM
"""
import csv
import gzip
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


class Cli(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "building.log"
        cls.truth = cls.work / "building.truth.tum"
        done = run("simulate", "-o", cls.log, "--truth", cls.truth, "--log-poses", "truth", "--rounds", 1, "--seed", 3,
                   "--office-area", 500, "--quiet")
        assert done.returncode == 0, done.stderr
        cls.map = cls.work / "building.flirt"
        done = run("map", cls.log, "-o", cls.map, "--quiet")
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def ok(self, *arguments: object) -> subprocess.CompletedProcess:
        done = run(*arguments)
        self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def json(self, *arguments: object) -> dict:
        return json.loads(self.ok(*arguments, "--json", "-").stdout)

    def test_every_command_has_help_with_an_example(self):
        for command in (["info"], ["detect"], ["match"], ["map"], ["localize"], ["slam"], ["simulate"], ["bench", "localization"], ["bench", "tracking"]):
            self.assertIn("Example: flirt " + command[0], self.ok(*command, "--help").stdout)

    def test_slam_writes_a_map_that_other_commands_read(self):
        out = self.work / "mapped"
        summary = self.json("slam", self.log, "-o", out, "--no-odometry")
        self.assertEqual({file.name for file in out.iterdir()},
                         {"trajectory.tum", "graph.g2o", "map.pgm", "map.yaml", "map.png", "map.flirt", "report.html", "summary.json"})
        self.assertEqual(json.loads((out / "summary.json").read_text()), summary)
        poses = (out / "trajectory.tum").read_text().splitlines()
        self.assertEqual(len([line for line in poses if not line.startswith("#")]), summary["scans"])
        error = self.json("evaluate", out / "trajectory.tum", "--truth", self.truth, "--stamp-tolerance", 0.001)
        self.assertLess(error["ate"]["translation_m"]["rmse"], 0.1)
        found = self.json("localize", out / "map.flirt", self.log, "--scan", 10)
        self.assertTrue(found)
        pgm = (out / "map.pgm").read_bytes()
        self.assertLessEqual(set(pgm[-5000:]), {0, 60, 115, 205, 254})
        self.assertIn("resolution: 0.05", (out / "map.yaml").read_text())

    def test_slam_refuses_what_it_cannot_use(self):
        self.assertEqual(run("slam", self.log).returncode, 1)
        self.assertEqual(run("slam", self.log, "-o", self.work / "x", "--window", 0).returncode, 1)
        self.assertEqual(run("slam", self.log, "-o", self.work / "x", "--front-end", "nonsense").returncode, 1)
        done = run("slam", self.work / "missing.log", "-o", self.work / "not-made")
        self.assertEqual(done.returncode, 2)
        self.assertIn("missing.log", done.stderr)
        self.assertFalse((self.work / "not-made").exists())
        self.assertEqual(run("slam", self.log, "-o", self.log / "below-a-file").returncode, 2)

    def test_version_names_the_commit(self):
        self.assertRegex(self.ok("--version").stdout, r"flirt \d+\.\d+\.\d+ \(\w+")

    def test_usage_errors_exit_1(self):
        for arguments in ([], ["nonsense"], ["info"], ["info", self.log, "--nonsense"], ["detect", self.log, "--detector", "x"],
                          ["match", self.log, "--scan", 0, "--against", 1, "--ransac-inlier-distance", "-1"],
                          ["match", self.log, "--scan", 0, "--against", 1, "--ransac-inlier-distance", "soon"]):
            done = run(*arguments)
            self.assertEqual(done.returncode, 1, f"{arguments}: {done.stderr}")
            self.assertNotEqual(done.stderr, "")

    def test_bad_input_exits_2_with_file_and_line(self):
        broken = self.work / "broken.log"
        broken.write_text("# comment\nFLASER 3 1.0 2.0\n")
        done = run("info", broken)
        self.assertEqual(done.returncode, 2)
        self.assertTrue(done.stderr.startswith(f"flirt: {broken}:2: "), done.stderr)
        self.assertEqual(run("info", self.work / "missing.log").returncode, 2)
        self.assertEqual(run("localize", self.log, self.log).returncode, 2, "a log is no map")
        cut = self.work / "cut.flirt"
        cut.write_bytes(self.map.read_bytes()[:-1])
        self.assertEqual(run("localize", cut, self.log).returncode, 2)

    def test_nothing_is_half_written(self):
        target = self.work / "no" / "such" / "folder" / "map.flirt"
        self.assertEqual(run("map", self.log, "-o", target).returncode, 2)
        self.assertFalse(target.exists())
        self.assertEqual([p for p in self.work.rglob("*") if "tmp" in p.name], [])

    def test_info_counts_scans_and_says_what_it_skipped(self):
        info = self.json("info", self.log)
        self.assertGreater(info["scans"], 100)
        self.assertEqual(info["beams"], {"fewest": 360, "most": 360})
        packed = self.work / "packed.log.gz"
        packed.write_bytes(gzip.compress(self.log.read_bytes()))
        self.assertEqual(self.json("info", packed)["scans"], info["scans"])

    def test_detect_prints_one_json_line_a_scan(self):
        lines = self.ok("detect", self.log, "--scan", 5, "--json", "-").stdout.splitlines()
        self.assertEqual(len(lines), 1)
        scan = json.loads(lines[0])
        self.assertEqual(scan["scan"], 5)
        for keypoint in scan["keypoints"]:
            self.assertEqual(len(keypoint["descriptor"]), 48)
            self.assertAlmostEqual(sum(keypoint["descriptor"]), 1, places=4)

    def test_all_detectors_and_descriptors_draw_their_picture(self):
        for detector in ("curvature", "range", "normal-edge", "normal-blob"):
            for descriptor in ("beta-grid", "shape-context"):
                picture = self.work / f"{detector}-{descriptor}.svg"
                self.ok("detect", self.log, "--scan", 3, "--detector", detector, "--descriptor", descriptor, "--svg", picture)
                self.assertIn("<svg", picture.read_text())

    def test_a_scan_matches_itself_exactly(self):
        result = self.json("match", self.log, "--scan", 10, "--against", 10)
        pose = result["alignment"]
        self.assertAlmostEqual(math.hypot(pose["x"], pose["y"]), 0, places=4)

    def test_config_file_lies_between_defaults_and_flags(self):
        config = self.work / "flirt.toml"
        config.write_text("[ransac]\ninlier_distance = 0.2\nmin_inliers = 4\n")
        result = self.json("match", self.log, "--scan", 1, "--against", 2, "--config", config, "--ransac-min-inliers", 5)
        self.assertEqual(result["params"]["ransac"]["inlier_distance"], 0.2)
        self.assertEqual(result["params"]["ransac"]["min_inliers"], 5)
        config.write_text("[ransac]\ninlier_distanse = 0.2\n")
        done = run("match", self.log, "--scan", 1, "--against", 2, "--config", config)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{config}:2: ", done.stderr)

    def test_localize_finds_a_scan_of_the_map(self):
        result = self.json("localize", self.map, self.log, "--scan", 20)
        query = result["queries"][0]
        self.assertEqual(query["scan"], 20)
        self.assertIn(query["verdict"], ("unique", "ambiguous"))
        best = query["hypotheses"][0]
        self.assertEqual(len(best["covariance"]), 9)
        with open(self.truth, encoding="utf-8") as file:
            truth = [line.split() for line in file if not line.startswith("#")][20]
        # The robot's true pose; the scanner of the default robot sits less than half a metre from its centre.
        self.assertLess(math.hypot(best["x"] - float(truth[1]), best["y"] - float(truth[2])), 0.5)

    def test_a_lost_scan_exits_4(self):
        blind = self.work / "blind.log"
        blind.write_text("FLASER 4 81.83 81.83 81.83 81.83 0 0 0 0 0 0 1.0 host 1.0\n")
        done = run("localize", self.map, blind, "--scan", 0, "--json", "-")
        self.assertEqual(done.returncode, 4)
        self.assertEqual(json.loads(done.stdout)["queries"][0]["verdict"], "lost")

    def test_map_of_a_log_at_the_poses_of_another_program(self):
        """A log of odometry alone, and a trajectory without its last ten scans."""
        raw, truth = self.work / "posed.log", self.work / "posed.log.truth.tum"
        self.ok("simulate", "-o", raw, "--rounds", 1, "--office-area", 200, "--drive-round-length", 20, "--quiet")
        poses = [line for line in truth.read_text().splitlines() if not line.startswith("#")]
        some = self.work / "some.tum"
        some.write_text("\n".join(poses[:-10]) + "\n")
        out = self.work / "posed.flirt"
        found = self.json("map", raw, "--poses", some, "-o", out)
        self.assertEqual((found["map_scans"], found["poses"]), (len(poses) - 10, "corrected_and_odometry"))
        for answer in self.json("localize", out, raw, "--every", 7)["queries"]:
            x, y = map(float, poses[answer["scan"]].split()[1:3])
            best = answer["hypotheses"][0]
            self.assertLess(math.hypot(best["x"] - x, best["y"] - y), 0.2, answer["scan"])
        found = self.json("bench", "localization", raw, "--poses", truth, "--every", 20)
        self.assertEqual((found["poses"], found["queries"]), (str(truth), -(-len(poses) // 20)))
        other = self.work / "other.tum"
        other.write_text("1e9 0 0 0 0 0 0 1\n")
        done = run("map", raw, "--poses", other, "-o", self.work / "none.flirt")
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected poses with stamps of scans", done.stderr)
        self.assertFalse((self.work / "none.flirt").exists())

    def test_a_map_needs_poses(self):
        raw = self.work / "raw.log"
        raw.write_text("RAWLASER1 0 -1.57 3.14 0.01745 50 0.1 0 3 1 2 3 0 1.0 host 1.0\n")
        done = run("map", raw, "-o", self.work / "raw.flirt")
        self.assertEqual(done.returncode, 2)
        self.assertIn("poses", done.stderr)

    def test_a_second_visit_is_localized_and_reported(self):
        second = self.work / "second.log"
        self.ok("simulate", "-o", second, "--log-poses", "truth", "--rounds", 1, "--seed", 4, "--office-area", 500,
                "--people", 3, "--quiet")
        out = self.work / "report"
        done = self.ok("localize", self.map, second, "--every", 5, "-o", out, "--summary")
        share = float(done.stdout.split("right: within 0.5 m and 10° of the log's pose")[1].split()[0])
        self.assertGreater(share, 0.5)
        page = (out / "report.html").read_text()
        self.assertIn("<svg", page)
        self.assertNotIn("http://", page.replace("http://www.w3.org/", ""))

    def test_localize_is_the_same_on_any_number_of_threads(self):
        def poses(threads):
            result = self.json("localize", self.map, self.log, "--every", 50, "--threads", threads)
            return [[(h["x"], h["y"], h["theta"]) for h in query["hypotheses"]] for query in result["queries"]]
        self.assertEqual(poses(1), poses(3))

    def test_bench_localization_keeps_its_contract(self):
        out = self.work / "bench"
        for protocol in ("paper", "revisit"):
            result = self.json("bench", "localization", self.log, "--protocol", protocol, "--every", 40, "-o", out)
            for key in ("log", "protocol", "queries", "answerable", "features_per_scan", "time_us", "map_scans", "params",
                        "seed", "commit", "cpu"):
                self.assertIn(key, result)
            for key in ("detect", "describe", "per_query_median", "per_query_p95", "per_pair"):
                self.assertIn(key, result["time_us"])
            if protocol == "paper":
                for strategy in ("closest", "corresp", "residual"):
                    curve = result["strategies"][strategy]
                    self.assertEqual(curve["n_min"], list(range(3, 16)))
                    self.assertEqual(len(curve["precision"]), 13)
                    self.assertIn("p_gl", curve)
                    self.assertIn("p_cl", curve)
                    self.assertEqual(len(curve["recall_wilson"]), 13)
                    low, high = curve["p_cl_wilson"]
                    self.assertTrue(low <= curve["p_cl"] <= high)
                self.assertIsNone(result["revisit"])
                self.assertIsNone(result["time_us"]["search"], "no dense search ran")
            else:
                for key in ("recall_at_95", "recall_at_99", "recall_at_100", "unique_found", "success", "success_025m_5deg"):
                    low, high = result["revisit"][f"{key}_wilson"]
                    self.assertTrue(low <= result["revisit"][key] <= high, key)
                self.assertIn("average_precision", result["revisit"])
                self.assertEqual(result["strategies"], {})
                self.assertIsNone(result["time_us"]["detect"], "no keypoints were looked for")
            self.assertEqual(result["feature_params"]["detector"]["name"], "curvature")
            with open(out / "queries.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(list(rows[0]), "query,strategy,answerable,reference,x,y,theta,confidence,inliers,residual,"
                                            "verdict,correct".split(","))
            self.assertEqual(len(rows), result["queries"] * (3 if protocol == "paper" else 1))
            if protocol == "paper":
                correct = sum(row["correct"] == "1" for row in rows if row["strategy"] == "residual")
                self.assertAlmostEqual(correct / result["queries"], result["strategies"]["residual"]["p_gl"])
            self.assertIn("<svg", (out / "report.html").read_text())

    def test_bench_localization_weighs_the_variances_of_both_sides(self):
        # So near that a match of scan 120 is one only because the map's variances count, too.
        out = self.work / "variances"
        flags = ["--match-distance", "variance-chi-square", "--match-max-distance", 0.005]
        self.ok("bench", "localization", self.log, "--every", 20, "-o", out, *flags, "--quiet")
        with (out / "queries.csv").open() as lines:
            answers = [row for row in csv.DictReader(lines) if row["strategy"] == "residual" and row["query"] != "0"]
        pairs = 0
        for answer in answers:
            pair = self.json("match", self.log, "--scan", answer["query"], "--against", int(answer["query"]) - 1, *flags)
            if pair["alignment"]:
                pairs += 1
                self.assertNotEqual(answer["reference"], "", f"{answer['query']} has a match, the scan before it")
                self.assertLessEqual(float(answer["residual"]), pair["alignment"]["residual"] + 1e-6)
        self.assertGreater(pairs, 5)

    def test_bench_localization_counts_distractors_apart(self):
        out = self.work / "distractors"
        other = self.work / "elsewhere.log"
        self.ok("simulate", "-o", other, "--office-area", 200, "--rounds", 1, "--office-seed", 9, "--seed", 9,
                   "--log-poses", "truth")
        result = self.json("bench", "localization", self.log, "--protocol", "revisit", "--every", 80, "--distractors",
                           other, "-o", out)
        found = result["revisit"]["distractors"]
        self.assertGreater(found["queries"], 0)
        self.assertAlmostEqual(found["rate"], found["unique"] / found["queries"])
        self.assertEqual(sum(found["confidence_tenths"]), found["queries"])
        self.assertEqual(set(result["revisit"]["nees"]),
                         {"answers", "within_50", "within_50_wilson", "within_90", "within_90_wilson", "within_95",
                          "within_95_wilson", "median"})
        with open(out / "queries.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        others = [row for row in rows if row["strategy"] == "distractor:1"]
        self.assertEqual(len(others), found["queries"])
        self.assertEqual(len(rows), result["queries"] + found["queries"])
        self.assertEqual({(row["answerable"], row["correct"]) for row in others}, {("0", "0")})
        self.assertEqual(sum(row["verdict"] == "unique" for row in others), found["unique"])

    def test_bench_localization_compares_variants_with_full(self):
        result = self.json("bench", "localization", self.log, "--protocol", "revisit", "--every", 80, "--ablation",
                           "--variants", "no-through,papers")
        self.assertEqual([row["name"] for row in result["ablation"]], ["full", "no-through", "papers"])
        for row in result["ablation"]:
            self.assertLessEqual(row["mcnemar_p"], 1)
        wrong = run("bench", "localization", self.log, "--protocol", "revisit", "--ablation", "--variants", "x")
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("no-through", wrong.stderr)

    def test_bench_buildings_asks_offices_and_grid_maps(self):
        result = self.json("bench", "buildings", "--office-area", 200, "--queries", 6, "--fields-of-view", 360,
                           "--people", "0,20")
        self.assertEqual([row["building"] for row in result["buildings"]], ["office 1", "office 1"])
        self.assertGreater(result["buildings"][1]["people"], 0.15)
        for row in result["buildings"]:
            self.assertLessEqual(row["success"]["of"] + row["twins"]["of"], 6)

    def test_bench_buildings_asks_offices_in_which_things_moved(self):
        result = self.json("bench", "buildings", "--office-area", 200, "--queries", 6, "--fields-of-view", 360,
                           "--people", 0, "--changed", "0,50")
        self.assertEqual([row["changed"] for row in result["buildings"]], [0, 0.5])
        self.assertGreater(result["buildings"][1]["success"]["of"] + result["buildings"][1]["twins"]["of"], 0)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
