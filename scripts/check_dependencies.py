#!/usr/bin/env python3
"""Checks over the includes that modules depend on each other one way only, and that pure modules stay pure."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# What each folder of flirt/ may include besides itself; transitive closure is spelled out so that a reader sees it.
ALLOWED = {
    "core": set(),
    "features": {"core"},
    "match": {"core", "features"},
    "grid": {"core"},
    "registration": {"core", "grid"},
    "map": {"core", "features", "match", "grid", "registration"},
    "graph": {"core"},
    "arena": {"core", "features", "match", "graph"},
    "slam": {"core", "features", "match", "grid", "registration", "map", "graph"},
    "sim": {"core", "grid"},
    "eval": {"core", "features", "match", "grid", "registration", "map", "graph", "arena", "slam", "sim"},
    "io": {"core", "features", "match", "grid", "registration", "map", "graph", "arena", "slam", "eval", "sim"},
    "report": {"core", "features", "match", "grid", "registration", "map", "graph", "arena", "slam", "eval", "io"},
}
# These also compile where there is no file system: no files, no text parsing, no exceptions.
PURE = {"core", "features", "match", "grid", "registration", "map", "graph", "arena", "slam"}
IMPURE_HEADERS = {"filesystem", "fstream", "iostream", "cstdio", "charconv", "sstream", "stdexcept", "exception"}
PURE_EXCEPTIONS = {"flirt/core/assert.hpp"}  # prints before it aborts, in checked builds only

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def main() -> int:
    complaints = []
    for path in sorted((ROOT / "flirt").rglob("*.[ch]pp")):
        relative = path.relative_to(ROOT).as_posix()
        module = relative.split("/")[1]
        if module not in ALLOWED:
            complaints.append(f"{relative}: module '{module}' is not in ALLOWED of {pathlib.Path(__file__).name}")
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            found = INCLUDE.match(line)
            if not found:
                if module in PURE and re.search(r"\b(throw|try|catch)\b\s*[({\w]", line.split("//")[0]):
                    complaints.append(f"{relative}:{number}: exceptions are not used in {module}")
                continue
            kind, header = found.groups()
            if kind == '"':
                if not header.startswith("flirt/"):
                    complaints.append(f'{relative}:{number}: expected "flirt/...", found "{header}"')
                    continue
                other = header.split("/")[1]
                if other != module and other not in ALLOWED[module]:
                    complaints.append(f"{relative}:{number}: {module} must not depend on {other}")
                if not (ROOT / header).exists():
                    complaints.append(f"{relative}:{number}: no such header: {header}")
            elif module in PURE and header in IMPURE_HEADERS and relative not in PURE_EXCEPTIONS:
                complaints.append(f"{relative}:{number}: {module} must not include <{header}>")
    print("\n".join(complaints) if complaints else "dependencies: as designed")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
