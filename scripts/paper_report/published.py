"""What the papers print. P1: FLIRT – Interest Regions for 2D Range Data with Applications to Robot Navigation; P2: ICRA 2010."""

# P1 Table 1: size m, scans, interest points a scan, p_GL and p_LC of the strategies closest and residual, t_sm s, t_ss µs.
P1_TABLE_1 = {
    "fr079": ("50×20", 1464, 27, .98, .98, .98, .98, .66, 450),
    "intel": ("50×40", 2672, 18, .98, .98, .96, .96, .52, 200),
    "csail": ("80×60", 1051, 23, .97, .97, .89, .73, .33, 320),
    "fr-clinic": ("550×300", 6917, 34, .96, .96, .85, .65, 6.45, 930),
    "Victoria Park": ("500×500", 5751, 20, .97, .97, .79, .38, 2.05, 357),
}

# P2 Table I: size m, scans, interest points a scan, p_GL, p_LC, t_sm s, t_ss µs.
P2_TABLE_1 = {
    "fr079": ("50×20", 1464, 27, .98, .98, .66, 450),
    "intel": ("50×40", 2672, 18, .98, .98, .52, 200),
    "csail": ("80×60", 1051, 23, .97, .97, .33, 320),
    "fr-clinic": ("550×300", 1776, 34, .79, .53, 1.15, 650),
}

# P1 Table 2: RBPF with 50 particles, graph of Olson's matcher, graph of FLIRT; mean ± sd.
P1_TABLE_2 = {
    ("fr079", "m"): (".06 ± .04", ".06 ± .04", ".06 ± .09"),
    ("intel", "m"): (".07 ± .08", ".03 ± .03", ".02 ± .02"),
    ("fr-clinic (local)", "m"): (".64 ± 2.64", ".14 ± .18", ".18 ± .27"),
    ("fr-clinic (global)", "m"): ("12.3 ± 11.7", "11.6 ± 11.9", "8.3 ± 8.6"),
    ("fr079", "°"): (".6 ± .6", ".6 ± .6", ".8 ± 1.1"),
    ("intel", "°"): ("3.0 ± 5.3", "1.3 ± 4.7", ".3 ± .3"),
    ("fr-clinic (local)", "°"): ("1.3 ± 2.3", ".9 ± 2.2", ".9 ± 2.0"),
    ("fr-clinic (global)", "°"): ("5.5 ± 5.9", "6.3 ± 6.2", "5.0 ± 5.3"),
}

DETECTOR_CLAIM = ("P2 §IV-B prints curves, no numbers. Its claims: the curvature detector is best in all situations but for noise of more "
                  "than σ = 0.25 m, where the range detector is; curvature is flat under sub- and oversampling.")
DESCRIPTOR_CLAIM = ("P2 §IV-C prints curves, no numbers. Its claims: the β-grid performs slightly better than the shape context; curvature "
                    "with β-grid is the best of all combinations.")
FIGURE_2_CLAIM = {
    "background of the jump": "largest scale only",
    "foreground of the jump": "all scales",
    "convex corner": "all scales",
    "obtuse concave corner": "scales 1 and 2",
}
CROWD_CLAIMS = {  # P1 Fig. 9 and 10 are pictures without numbers
    "tunnel": "Fig. 9: accurate by FLIRT, far better than by ICP",
    "station": "Fig. 10: largely consistent by FLIRT, clearly more precise than by ICP",
}
