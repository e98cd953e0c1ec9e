#!/usr/bin/env python3
"""clang-tidy-19 over every source of the library and the program, one process per core; exits 1 when any complains.

usage: scripts/run_tidy.py BUILD_DIR [FILE...]
"""
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys


def main() -> int:
    build = pathlib.Path(sys.argv[1])
    commands = json.loads((build / "compile_commands.json").read_text())
    sources = sorted({entry["file"] for entry in commands if re.search(r"/(flirt|apps)/[^/]+/[^/]+$", entry["file"])})
    if len(sys.argv) > 2:
        wanted = {str(pathlib.Path(name).resolve()) for name in sys.argv[2:]}
        sources = [source for source in sources if source in wanted]

    def tidy(source: str) -> tuple[str, int, str]:
        run = subprocess.run(
            ["clang-tidy-19", "--quiet", "--extra-arg=-Wno-unknown-warning-option", "-p", str(build), source], capture_output=True, text=True, check=False
        )
        return source, run.returncode, run.stdout

    failures = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, code, output in pool.map(tidy, sources):
            if code != 0:
                failures += 1
                print(f"{source}\n{output}")
    print(f"clang-tidy: {len(sources)} files, {failures} with complaints")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
