#!/usr/bin/env python3
"""Installs the build to a temporary prefix and builds and runs the README's C++ program against it.

usage: install_test.py BUILD_DIR SOURCE_DIR FLIRT_PROGRAM
"""
import pathlib
import re
import subprocess
import sys
import tempfile


def run(*command: object) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command}\nexit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def main() -> None:
    build, source, flirt = (pathlib.Path(argument) for argument in sys.argv[1:4])
    program = re.search(r"```cpp\n(.*?)```", (source / "README.md").read_text(), re.DOTALL)
    assert program, "expected a C++ program in README.md"
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "example.cpp").write_text(program.group(1))
        run("cmake", "--install", build, "--prefix", work / "prefix")
        run("cmake", "-S", source / "tests/install", "-B", work / "build", "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={work / 'prefix'}", f"-DEXAMPLE={work / 'example.cpp'}")
        run("cmake", "--build", work / "build")
        run(flirt, "simulate", "-o", work / "building.log", "--office-area", 500, "--rounds", 1, "--quiet")
        output = run(work / "build/example", work / "building.log")
        assert output.startswith(("unique", "ambiguous")), f"expected the scan to be found, got: {output}"
        run(work / "prefix/bin/flirt", "--version")


if __name__ == "__main__":
    main()
