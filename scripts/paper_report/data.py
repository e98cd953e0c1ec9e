"""The logs at hand: the papers' own where a folder holds them, simulated buildings where not."""
import dataclasses
import gzip
import math
import pathlib
import random

from .runner import Program, Size


@dataclasses.dataclass(frozen=True)
class SlamRun:
    """An input of flirt slam, and the poses that its map is compared with."""

    name: str
    file: pathlib.Path
    truth: pathlib.Path
    odometry: bool


@dataclasses.dataclass(frozen=True)
class Log:
    name: str
    file: pathlib.Path
    scans: int
    beams: int
    stands_for: str
    published: str = ""  # its name in the papers' tables
    relations: pathlib.Path | None = None  # of the poses, for Table 2
    runs: tuple["SlamRun", ...] = ()


@dataclasses.dataclass(frozen=True)
class Logs:
    corrected: list[Log]  # with true poses, as in the papers' Table 1
    tuning: list[Log]  # on which ablations may be looked at
    stand_ins: list[Log]  # for the papers' outdoor logs, which are not at hand: localization only
    simulated: bool


# Name, log with corrected poses, relations, and inputs with raw odometry: name, file, log with their true poses (by stamp).
REAL = (
    ("fr079", "fr079/flirtlib-fr079.log.gz", "fr079/fr079.relations", ()),
    ("intel", "intel/flirtlib-intel-lab.log.gz", "intel/intel.relations",
     (("910 scans, raw odometry", "intel/intel-910-merged.log.gz", "intel/intel-910-merged.log.gz"),)),
    ("csail", "mit-csail/flirtlib-mit-cscail.log.gz", None,
     (("1051 scans, raw odometry", "mit-csail/mit-csail-1051-merged.log.gz", "mit-csail/mit-csail-1051-merged.log.gz"),
      ("all 1988 scans, raw odometry", "mit-csail/mit-csail.clf.gz", "mit-csail/mit-csail-1051-merged.log.gz"))),
)
TUNING = (("aces", "aces/aces-corrected.log.gz"), ("fr101", "fr101/freiburg-101-corrected.log.gz"))


def described(program: Program, name: str, file: pathlib.Path, stands_for: str, **more) -> Log:
    info = program.json(program.folder("logs") / f"{name}.json", "info", file)
    return Log(name, file, info["scans"], info["beams"]["most"], stands_for, **more)


def existing(folder: pathlib.Path, relative: str | None) -> pathlib.Path | None:
    return folder / relative if relative and (folder / relative).exists() else None


def simulated(program: Program, size: Size, number: int) -> Log:
    """A building of its own with exact poses; the second with half the beams, as the intel log has."""
    folder = program.folder("logs")
    name = f"simulated-{number}"
    file, odometry, truth = folder / f"{name}.log", folder / f"{name}-odometry.log", folder / f"{name}.truth.tum"
    common = ("--office-seed", number, "--office-area", size.area, "--rounds", 1 if size.name == "smallest" else 2, "--lidar-beams",
              180 if number == 2 else 360, "--truth", truth)
    program.run("simulate", "-o", odometry, *common)
    program.run("simulate", "-o", file, "--log-poses", "truth", *common)
    runs = (SlamRun("drifting odometry", odometry, truth, True), SlamRun("no odometry", odometry, truth, False))
    return described(program, name, file, "a real log that is not here", runs=runs)


def write_every_second_scan(source: pathlib.Path, target: pathlib.Path) -> None:
    """The scans 1, 3, 5 … of a log of pose and scan lines in turn, so that the others can be looked for in their map."""
    opened = gzip.open(source, "rt") if source.suffix == ".gz" else source.open()
    counts: dict[str, int] = {}
    with opened, target.open("w") as out:
        for line in opened:
            kind = line.split(" ", 1)[0]
            if kind not in ("VERTEX2", "ROBOTLASER1"):
                continue
            counts[kind] = counts.get(kind, 0) + 1
            if counts[kind] % 2 == 0:
                out.write(line)


def grove(file: pathlib.Path, side: float, trees: int) -> None:
    """A fenced square of tree trunks, as segments: what Victoria Park mostly shows to a laser."""
    rng = random.Random(7)
    segments = []

    def outline(corners: list[tuple[float, float]]) -> None:
        segments.extend(f"{a[0]:.3f},{a[1]:.3f},{b[0]:.3f},{b[1]:.3f}" for a, b in zip(corners, corners[1:] + corners[:1]))

    placed: list[tuple[float, float]] = []
    while len(placed) < trees:
        middle = (rng.uniform(2, side - 2), rng.uniform(2, side - 2))
        if any(math.dist(middle, other) < 2.5 for other in placed):
            continue
        placed.append(middle)
        radius, phase = rng.uniform(0.15, 0.5), rng.uniform(0, 1)
        outline([(middle[0] + radius * math.cos(phase + k * math.pi / 4), middle[1] + radius * math.sin(phase + k * math.pi / 4))
                 for k in range(8)])
    outline([(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)])
    file.write_text("\n".join(segments) + "\n")


def outdoor_stand_ins(program: Program, size: Size) -> list[Log]:
    folder = program.folder("logs")
    sparse, trees, plan = folder / "sparse.log", folder / "grove.log", folder / "grove.txt"
    common = ("--log-poses", "truth", "--rounds", 1)
    program.run("simulate", "-o", sparse, *common, "--office-area", 4 * size.area, "--lidar-range-max", 80, "--drive-scan-distance", 1,
                "--drive-scan-turn", 3)
    side = 60 if size.name == "full" else 30
    grove(plan, side, side * side // 33)
    program.run("simulate", "-o", trees, *common, "--plan", plan, "--lidar-range-max", 30, "--drive-scan-distance", 0.5)
    return [described(program, "simulated-sparse", sparse, "fr-clinic as in P2: a scan a metre (but indoors)"),
            described(program, "simulated-grove", trees, "Victoria Park: tree trunks, no walls but a fence")]


def find_logs(data: str | None, program: Program, size: Size) -> Logs:
    corrected, tuning = [], []
    stand_ins = outdoor_stand_ins(program, size)
    if data:
        folder = pathlib.Path(data)
        for name, file, relations, inputs in REAL:
            if existing(folder, file):
                runs = [SlamRun(label, folder / source, folder / truth, True) for label, source, truth in inputs
                        if existing(folder, source) and existing(folder, truth)]
                runs.append(SlamRun("no odometry", folder / file, folder / file, False))
                corrected.append(described(program, name, folder / file, "itself: the papers' own scans", published=name,
                                           relations=existing(folder, relations), runs=tuple(runs)))
        for name, file in TUNING:
            if existing(folder, file):
                tuning.append(described(program, name, folder / file, "tuning: not in the papers"))
    if corrected:
        return Logs(corrected, tuning or [simulated(program, size, 1)], stand_ins, simulated=False)
    buildings = [simulated(program, size, 1)] if size.name == "smallest" else [simulated(program, size, n) for n in (1, 2)]
    return Logs(buildings, buildings[:1], stand_ins, simulated=True)
