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
FILE = ROOT / "bench/results/instructions.json"
RECORDED = json.loads(FILE.read_text())

STAND_IN = """#!/bin/sh
for word; do
  case "$word" in
    --callgrind-out-file=*) out="${word#*=}" ;;
  esac
done
case "$word" in
%s
esac
echo "totals: $n" > "$out"
echo "found 1"
%s
"""


class CompareInstructions(unittest.TestCase):
    def compare(self, share, **setting):
        """With each stage at `share` of its recorded count."""
        cases = "\n".join(f"{stage}) n={int(number * share)} ;;" for stage, number in RECORDED["instructions"].items())
        said = "\n".join(f"echo '{key} {value}'" for key, value in {**RECORDED["setting"], **setting}.items())
        with tempfile.TemporaryDirectory() as folder:
            valgrind = Path(folder) / "valgrind"
            valgrind.write_text(STAND_IN % (cases, said))
            valgrind.chmod(valgrind.stat().st_mode | stat.S_IXUSR)
            return subprocess.run([sys.executable, ROOT / "scripts/compare_instructions", "--probe", "/bin/true",
                                   "--against", FILE], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PATH": folder + ":/usr/bin:/bin"})

    def test_as_many_as_recorded_pass(self):
        done = self.compare(1.0)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count("+0.0%"), len(RECORDED["instructions"]))

    def test_a_little_more_passes(self):
        self.assertEqual(self.compare(1.14).returncode, 0)

    def test_sixteen_percent_more_fail_and_are_named(self):
        done = self.compare(1.16)
        self.assertEqual(done.returncode, 1)
        for stage in ("detect", "describe", "match", "query"):
            self.assertIn(stage, done.stdout.split("FAILED")[1])

    def test_nothing_counted_is_an_error(self):
        done = self.compare(0.0)
        self.assertEqual(done.returncode, 2)
        self.assertIn("counted nothing", done.stderr)

    def test_counts_of_other_kernels_are_not_compared(self):
        self.assertEqual(self.compare(2.0, target="SSE4").returncode, 77)


if __name__ == "__main__":
    unittest.main()
