"""scripts/compare_instructions, with a stand-in for valgrind that says what was counted."""

import json
import os
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORDED = json.loads((ROOT / "bench/results/instructions.json").read_text())["instructions"]


def stand_in(folder, name, lines):
    path = Path(folder) / name
    path.write_text("#!/bin/sh\n" + lines)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


class CompareInstructions(unittest.TestCase):
    def compare(self, share, compiler=None):
        """With each stage at `share` of its recorded count."""
        with tempfile.TemporaryDirectory() as folder:
            cases = "".join(f"*{stage}) n={int(number * share)};;\n" for stage, number in RECORDED.items())
            stand_in(folder, "valgrind", f'case "$*" in\n{cases}esac\necho "Collected : $n" >&2\n')
            known = json.loads((ROOT / "bench/results/instructions.json").read_text())["compiler"]
            stand_in(folder, "c++", f"echo '{compiler or known}'\n")
            return subprocess.run(
                [sys.executable, ROOT / "scripts/compare_instructions", "--probe", "/bin/true"],
                capture_output=True, text=True, check=False, env={**os.environ, "PATH": folder + ":/usr/bin:/bin"})

    def test_as_many_as_recorded_pass(self):
        done = self.compare(1.0)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count("+0.0 %"), len(RECORDED))

    def test_a_little_more_passes(self):
        self.assertEqual(self.compare(1.14).returncode, 0)

    def test_sixteen_percent_more_fail_and_are_named(self):
        done = self.compare(1.16)
        self.assertEqual(done.returncode, 1)
        self.assertIn("detect, describe, match, query: more than 15 %", done.stderr)
        self.assertIn("--record", done.stderr)

    def test_nothing_counted_is_an_error(self):
        done = self.compare(0.0)
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected a count of instructions", done.stderr)

    def test_counts_of_another_compiler_are_not_compared(self):
        self.assertEqual(self.compare(2.0, "c++ of another maker").returncode, 77)


if __name__ == "__main__":
    unittest.main()
