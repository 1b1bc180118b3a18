"""Redraw figures 9 to 12 of paper A (Siswanto and Ibrahim) into a folder.

    python examples/paper_a.py out/

The compactor of `examples/compactor.toml`. The paper names one eccentricity for figures 9 and 10, 0.15 m, and
0.22 and 0.23 m for figures 11 and 12; the others are ours.
"""

import sys
from functools import cache

import numpy as np

import desaxe as dx

MACHINE = {"AB": 0.125, "BC": 0.350, "omega0": 157.08}
THETA = np.linspace(0.0, 2.0 * np.pi, 1441)
TRIED, LIMIT = (0.0, 0.05, 0.10, 0.15, 0.20), (0.0, 0.15, 0.22, 0.23)  # eccentricities [m]

FIGURES = {
    9: ("Velocity of the slider in various eccentricity values", "V_C", TRIED),
    10: ("Acceleration history in various eccentricity values", "a_C", TRIED),
    11: ("Unfeasible design detection (acceleration function)", "a_C", LIMIT),
    12: ("Unfeasible design detection (velocity function)", "V_C", LIMIT),
}


@cache
def grid(eccentricities):
    """Velocity and acceleration over the turn."""
    return dx.grid(["V_C", "a_C"], ec=np.array(eccentricities), theta=THETA, **MACHINE)


def draw(number, ax=None):
    """One figure; its Axes."""
    title, name, eccentricities = FIGURES[number]
    axes = dx.plot.curves(grid(eccentricities), name, ax=ax)[0].axes
    axes.set_title(f"Paper A, figure {number}: {title}", loc="left", fontsize="medium")
    return axes


def main(folder):
    """Draw everything; a line for each file."""
    for number, (title, *_) in FIGURES.items():
        print(dx.plot.save(draw(number).figure, f"{folder}/paper_a_{number:02}.png"), "-", title)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
