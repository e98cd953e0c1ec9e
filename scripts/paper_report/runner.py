"""Runs the program flirt, and remembers how."""
import dataclasses
import json
import pathlib
import shlex
import subprocess
import sys
import time


@dataclasses.dataclass(frozen=True)
class Size:
    """How much of each experiment is run."""

    name: str
    every: int  # every K-th scan is a query of the localization tables
    locations: int  # reference locations of the detector and descriptor benches; 0: the papers' 20 a log
    many_locations: int  # of the second, larger run; 0: none
    partners: int  # scans a location and level of overlap; 0: all
    ablation_every: int  # 0: no ablations
    area: int  # m², of simulated buildings
    particles: int  # of the rival of Table 2
    places: str  # of the simulated station among people
    arena_queries: int  # a log; 0: no arena

    @staticmethod
    def full() -> "Size":
        return Size("full", 1, 0, 300, 0, 1, 1200, 50, "tunnel,station", 100)

    @staticmethod
    def quick() -> "Size":
        return Size("quick", 12, 0, 0, 5, 6, 600, 4, "tunnel", 10)

    @staticmethod
    def smallest() -> "Size":
        return Size("smallest", 20, 2, 0, 1, 0, 200, 4, "tunnel", 2)


class Program:
    """The program with the seed and threads of this run; every command is kept for the report."""

    def __init__(self, executable: pathlib.Path, out: pathlib.Path, seed: int, threads: int):
        self.executable = executable
        self.out = out
        self.common = ["--seed", str(seed), "--threads", str(threads), "--quiet"]
        self.seed = seed
        self.history: list[tuple[str, float]] = []

    def version(self) -> str:
        return subprocess.run([self.executable, "--version"], capture_output=True, text=True, check=True).stdout.strip()

    def folder(self, name: str) -> pathlib.Path:
        folder = self.out / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def run(self, *arguments: object, allowed: tuple[int, ...] = (0,)) -> None:
        command = [str(self.executable), *map(str, arguments), *self.common]
        start = time.monotonic()
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.history.append((shlex.join(["flirt", *command[1:]]), time.monotonic() - start))
        if done.returncode not in allowed:
            sys.exit(f"reproduce: {self.history[-1][0]}\n{done.stderr.strip()}\nexpected exit code {allowed}, found {done.returncode}")

    def json(self, file: pathlib.Path, *arguments: object, allowed: tuple[int, ...] = (0,)) -> dict:
        """Runs the command with --json `file`, and reads that."""
        self.run(*arguments, "--json", file, allowed=allowed)
        return self.read(file)

    @staticmethod
    def read(file: pathlib.Path):
        return json.loads(file.read_text())
