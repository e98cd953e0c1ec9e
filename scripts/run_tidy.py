#!/usr/bin/env python3
"""clang-tidy-19 over every source of the library and the program, one process per core; exits 1 when any complains.

usage: scripts/run_tidy.py BUILD_DIR [FILE...]

Sources that the build compiles as one are looked at as one: headers are read once for all of them.

A source that passed is not looked at again until it, a header of this project that it includes, its compile command,
.clang-tidy or the linter changes: BUILD_DIR/tidy-passed holds one empty file per source that passed, named by a hash of
all that. System headers are taken not to change; delete the folder to start anew.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# GCC's flags that clang does not know, and the deprecated parts that GCC's own std::stable_sort uses.
EXTRA = ["--extra-arg=-Wno-unknown-warning-option", "--extra-arg=-Wno-deprecated-declarations"]
# A source of the library or the program, or several of them as one.
WANTED = re.compile(r"/(flirt|apps)/[^/]+/[^/]+\.cpp$|/(flirt_[a-z]+)\.dir/Unity/[^/]+$")
INCLUDE = re.compile(rb'^\s*#\s*include\s*"((?:/[^"]*/)?(?:flirt|apps)/[^"]+)"', re.MULTILINE)


def project_files(source: pathlib.Path) -> list[pathlib.Path]:
    """The source and every header of the project behind it."""
    found, waiting = set(), [source]
    while waiting:
        path = waiting.pop()
        if path in found or not path.exists():
            continue
        found.add(path)
        waiting += [ROOT / name.decode() for name in INCLUDE.findall(path.read_bytes())]
    return sorted(found)


def key_of(entry: dict, common: bytes) -> str:
    digest = hashlib.sha256(common)
    digest.update(entry["command"].encode())
    for path in project_files(pathlib.Path(entry["file"])):
        digest.update(str(path).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def main() -> int:
    start = time.monotonic()
    build = pathlib.Path(sys.argv[1])
    commands = json.loads((build / "compile_commands.json").read_text())
    entries = {entry["file"]: entry for entry in commands if WANTED.search(entry["file"])}
    if len(sys.argv) > 2:
        wanted = {str(pathlib.Path(name).resolve()) for name in sys.argv[2:]}
        entries = {name: entry for name, entry in entries.items() if name in wanted}

    version = subprocess.run(["clang-tidy-19", "--version"], capture_output=True, check=True).stdout
    common = version + (ROOT / ".clang-tidy").read_bytes() + pathlib.Path(__file__).read_bytes()
    passed = build / "tidy-passed"
    passed.mkdir(exist_ok=True)
    keys = {name: key_of(entry, common) for name, entry in entries.items()}
    # The largest first, so that none is left over at the end for one core alone.
    size = {name: sum(path.stat().st_size for path in project_files(pathlib.Path(name))) for name in entries}
    todo = sorted((name for name in entries if not (passed / keys[name]).exists()), key=size.get, reverse=True)

    def tidy(source: str) -> tuple[str, int, str]:
        run = subprocess.run(
            ["clang-tidy-19", "--quiet", *EXTRA, "-p", str(build), source], capture_output=True, text=True, check=False
        )
        return source, run.returncode, run.stdout

    failures = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, code, output in pool.map(tidy, todo):
            if code == 0:
                (passed / keys[source]).touch()
            else:
                failures += 1
                print(f"{source}\n{output}", flush=True)
    if len(sys.argv) == 2:  # what no source needs any more
        for stale in set(os.listdir(passed)) - set(keys.values()):
            (passed / stale).unlink()
    print(f"clang-tidy: {len(entries)} files, {len(todo)} looked at, {failures} with complaints, {time.monotonic() - start:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
