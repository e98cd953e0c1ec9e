"""The scene of figure 2 of both papers, as a log: exact ranges to four walls."""
import math
import pathlib

# m, sensor at the origin: a background wall; in front of it a wall that begins in the open, turns away at a convex corner and towards the
# sensor again at an obtuse concave one.
EDGE, CONVEX, CONCAVE = (3.1, -1.5), (1.84, 1.14), (3.8, 3.42)
WALLS = (((13.5, -7.9), (2.57, 0.85)), (EDGE, CONVEX), (CONVEX, CONCAVE), (CONCAVE, (4.3, 7.4)))
START, STEP, COUNT, LONGEST = -75.0, 1.0, 150, 30.0  # degrees, degrees, beams, m


def cast(angle: float) -> float:
    x, y = math.cos(angle), math.sin(angle)
    nearest = LONGEST
    for (ax, ay), (bx, by) in WALLS:
        across = x * (by - ay) - y * (bx - ax)
        if abs(across) < 1e-12:
            continue
        distance = (ax * (by - ay) - ay * (bx - ax)) / across
        share = (ax * y - ay * x) / across
        if distance > 0 and 0 <= share <= 1:
            nearest = min(nearest, distance)
    return nearest


def write_log(file: pathlib.Path) -> None:
    ranges = " ".join(f"{cast(math.radians(START + STEP * i)):.6f}" for i in range(COUNT))
    file.write_text(f"ROBOTLASER1 0 {math.radians(START)!r} {math.radians(STEP * COUNT)!r} {math.radians(STEP)!r} {LONGEST} 0.01 0 {COUNT} "
                    f"{ranges} 0 0 0 0 0 0 0 0 0 0 0 0 1.0 figure2 1.0\n")


def place_of(x: float, y: float, beam: int, scale: float) -> str:
    """Which part of the scene a keypoint belongs to."""
    if math.dist((x, y), EDGE) < 0.05 + 0.5 * scale:
        return "foreground of the jump"
    if math.dist((x, y), CONVEX) < 0.1:
        return "convex corner"
    if math.dist((x, y), CONCAVE) < 0.1:
        return "obtuse concave corner"
    return "background of the jump" if beam in (48, 49) else "elsewhere"
