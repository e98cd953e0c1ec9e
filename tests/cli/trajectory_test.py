#!/usr/bin/env python3
"""The commands about trajectories and pose graphs from outside: evaluate, convert, bench optimizers.

usage: trajectory_test.py FLIRT_PROGRAM
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


class Trajectory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.log = cls.work / "building.log"
        cls.truth = cls.work / "building.truth.tum"
        done = run("simulate", "-o", cls.log, "--truth", cls.truth, "--log-poses", "both", "--rounds", 1, "--seed", 3,
                   "--office-area", 500, "--quiet")
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

    def rows(self, path: pathlib.Path) -> list[list[float]]:
        return [[float(word) for word in line.split()] for line in path.read_text().splitlines()]

    def write_rows(self, name: str, rows: list[list[float]]) -> pathlib.Path:
        path = self.work / name
        path.write_text("".join(" ".join(repr(value) for value in row) + "\n" for row in rows))
        return path

    def test_every_command_has_help_with_an_example(self):
        for command in (["evaluate"], ["convert"], ["bench", "optimizers"]):
            self.assertIn("Example: flirt " + " ".join(command), self.ok(*command, "--help").stdout)

    def test_the_truth_has_no_error(self):
        result = self.json("evaluate", self.truth, "--truth", self.truth)
        self.assertLess(result["ate"]["translation_m"]["max"], 1e-9)
        self.assertLess(result["rpe"]["translation_m"]["max"], 1e-9)
        self.assertEqual(result["skipped"], 0)
        self.assertEqual(result["derived_relations"]["source"], "derived")
        for key in ("rmse", "mean", "sd", "median", "max", "count"):
            self.assertIn(key, result["ate"]["rotation_deg"])
            self.assertIn(key, result["derived_relations"]["motion"]["translation_m"])

    def test_ate_and_rpe_are_those_of_their_definitions(self):
        rows = self.rows(self.truth)
        noisy = [[row[0], row[1] + 0.1 * math.sin(i), row[2] + 0.1 * math.cos(3 * i), *row[3:]]
                 for i, row in enumerate(rows)]
        result = self.json("evaluate", self.write_rows("noisy.tum", noisy), "--truth", self.truth)
        points = [(complex(a[1], a[2]), complex(b[1], b[2])) for a, b in zip(noisy, rows)]
        n = len(points)
        mean_e, mean_t = sum(e for e, _ in points) / n, sum(t for _, t in points) / n
        turn = sum((t - mean_t) * (e - mean_e).conjugate() for e, t in points)
        turn /= abs(turn)
        errors = [abs(turn * (e - mean_e) + mean_t - t) for e, t in points]
        self.assertAlmostEqual(result["ate"]["translation_m"]["rmse"], math.sqrt(sum(e * e for e in errors) / n), 9)
        self.assertAlmostEqual(result["ate"]["translation_m"]["max"], max(errors), 9)
        way = [0.0]
        for (a, _), (b, _) in zip(points, points[1:]):
            way.append(way[-1] + abs(b - a))
        heading = [2 * math.atan2(row[6], row[7]) for row in rows]
        squares = []
        for i in range(n - 1):
            j = min(range(i + 1, n), key=lambda k: abs(way[k] - way[i] - 1.0))
            if abs(way[j] - way[i] - 1.0) <= 0.1:
                back = complex(math.cos(heading[i]), -math.sin(heading[i]))
                squares.append(abs(back * (points[j][0] - points[i][0]) - back * (points[j][1] - points[i][1])) ** 2)
        self.assertEqual(result["rpe"]["translation_m"]["count"], len(squares))
        self.assertAlmostEqual(result["rpe"]["translation_m"]["rmse"], math.sqrt(sum(squares) / len(squares)), 9)

    def test_relations_are_counted_and_both_forms_given(self):
        rows = self.rows(self.truth)
        file = self.work / "some.relations"
        file.write_text(f"{rows[0][0]!r} {rows[9][0]!r} 0 0 0 0 0 0\n-1 {rows[3][0]!r} 0 0 0 0 0 0\n")
        relations = self.json("evaluate", self.log, "--relations", file)["relations"]
        self.assertEqual((relations["source"], relations["count"], relations["skipped"]), ("official", 1, 1))
        way = math.hypot(rows[9][1] - rows[0][1], rows[9][2] - rows[0][2])
        self.assertAlmostEqual(relations["difference"]["translation_m"]["mean"], way, 6)
        self.assertAlmostEqual(relations["motion"]["translation_m"]["mean"], way, 6)

    def test_true_poses_make_a_sharper_map_than_odometry(self):
        def quality(name: str, poses: list[list[float]]) -> dict:
            return self.json("evaluate", self.write_rows(name, poses), "--scans", self.log)["map_quality"]
        rows = self.rows(self.truth)
        bent = [[row[0], row[1] + 0.02 * math.sin(7 * i), *row[2:]] for i, row in enumerate(rows)]
        right, wrong = quality("right.tum", rows), quality("bent.tum", bent)
        self.assertEqual(right["scans"], len(rows))
        self.assertLess(right["point_to_line_rms_m"], wrong["point_to_line_rms_m"])
        self.assertLess(right["occupied_cells"], wrong["occupied_cells"])

    def test_evaluate_needs_something_to_evaluate_against(self):
        self.assertEqual(run("evaluate", self.truth).returncode, 1)
        other = self.write_rows("other.tum", [[1e9, 0, 0, 0, 0, 0, 0, 1]])
        done = run("evaluate", other, "--truth", self.truth)
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected stamps of", done.stderr)

    def test_bad_input_exits_2_with_file_and_line(self):
        graph = self.work / "broken.g2o"
        graph.write_text("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 zero 0\n")
        done = run("convert", graph, self.work / "out.graph")
        self.assertEqual(done.returncode, 2)
        self.assertTrue(done.stderr.startswith(f"flirt: {graph}:2: "), done.stderr)
        self.assertFalse((self.work / "out.graph").exists())
        self.assertEqual(run("bench", "optimizers", self.log).returncode, 2, "a log without a graph")

    def test_convert_writes_the_poses_of_a_log(self):
        out = self.work / "poses.tum"
        result = self.json("convert", self.log, out)
        self.assertIn("scans", result["lost"])
        self.assertIn("odometry", result["lost"])
        self.assertEqual(len(self.rows(out)), len(self.rows(self.truth)))
        for found, expected in zip(self.rows(out), self.rows(self.truth)):
            for a, b in zip(found, expected):
                self.assertAlmostEqual(a, b, 9)

    def test_a_log_survives_being_converted_to_a_log(self):
        copy = self.work / "copy.log"
        self.ok("convert", self.log, copy)
        before, after = self.json("info", self.log), self.json("info", copy)
        for key in ("scans", "beams", "angles", "ranges", "stamps"):
            self.assertEqual(before[key], after[key])
        error = self.json("evaluate", copy, "--truth", self.truth)["ate"]["translation_m"]
        self.assertEqual(error["count"], before["scans"])
        self.assertLess(error["max"], 1e-9)

    def test_graphs_go_through_either_format_unchanged(self):
        first, toro, second = self.work / "a.g2o", self.work / "a.graph", self.work / "b.g2o"
        made_up = self.json("convert", self.log, first)
        self.assertTrue(any("made up" in what for what in made_up["lost"]))
        self.json("convert", first, toro)
        self.json("convert", toro, second)
        self.assertEqual([line for line in first.read_text().splitlines() if not line.startswith("FIX")],
                         [line for line in second.read_text().splitlines() if not line.startswith("FIX")])
        self.assertEqual(self.json("convert", first, self.work / "a.x", "--to", "tum")["poses"], made_up["poses"])

    def test_convert_refuses_what_cannot_be(self):
        self.assertEqual(run("convert", self.truth, self.work / "scans.log").returncode, 2)
        self.assertEqual(run("convert", self.truth, self.work / "what.is.this").returncode, 1)

    def test_bench_optimizers_finds_the_graph_of_a_file(self):
        graph = self.work / "square.graph"
        corners = [(0, 0, 0), (1, 0, 1.5707963), (1, 1, 3.1415926), (0, 1, -1.5707963)]
        lines = [f"VERTEX2 {i} {x} {y} {t}" for i, (x, y, t) in enumerate(corners)]
        lines += [f"EDGE2 {i} {(i + 1) % 4} 1 0 1.5707963 100 0 100 500 0 0" for i in range(4)]
        graph.write_text("\n".join(lines) + "\n")
        result = self.json("bench", "optimizers", graph)["logs"][0]
        self.assertEqual((result["nodes"], result["edges"]), (4, 4))
        self.assertEqual([run["backend"] for run in result["runs"]], ["ceres", "toro"])
        for backend in result["runs"]:
            self.assertLess(backend["ate_m"], 1e-5)
            self.assertIn("cpu_seconds", backend)


if __name__ == "__main__":
    FLIRT = sys.argv.pop(1)
    unittest.main()
