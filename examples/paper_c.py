"""Redraw figures 5 to 11 of paper C (Gupta) into a folder.

    python examples/paper_c.py out/

The paper's X runs along the slider axis, as Y does here: its X-direction velocity and acceleration of the
slider are V_C and a_C. The motion starts from rest at theta = 0.
"""

import sys
from functools import cache

import numpy as np
from matplotlib.figure import Figure

import desaxe as dx

MACHINE = {"AB": 0.14, "BC": 0.31, "ec": 0.06}  # m; r, l, e
LINKS = {"m_crank": 0.7637, "m_rod": 1.559464, "m_slider": 1.95025}  # kg; centres of mass in the middle
INERTIAS = {"I_crank": 80.6e-6, "I_rod": 166.8085e-6}  # kg m2


def wave(t: float, theta: float, omega: float) -> float:
    """The torque of section 3.2 [N m]."""
    return 0.35 * (1.0 - np.cos(30.0 * t))


TORQUES = {  # N m, and seconds of each run
    "250 N mm": (0.25, 2.25),
    "500 N mm": (0.5, 2.25),
    "350 (1 - cos 30 t) N mm": (wave, 2.0),
}
SINGLE, DOUBLE, WAVY = TORQUES
UNITS = {"V_C": "m/s", "a_C": "m/s²", "T_in": "N m"}

FIGURES = {
    5: ("X-Component of Velocity of Slider D", "V_C", (SINGLE,)),
    6: ("X-Component of Acceleration of Slider D", "a_C", (SINGLE,)),
    7: ("X-Component of Velocity of Slider D", "V_C", (SINGLE, DOUBLE)),
    8: ("X-Component of Acceleration of Slider D", "a_C", (SINGLE, DOUBLE)),
    9: ("Sinusoidal Torque on input crank", "T_in", (WAVY,)),
    10: ("X-Component of Velocity of Slider D", "V_C", (WAVY,)),
    11: ("X-Component of Acceleration of Slider D", "a_C", (WAVY,)),
}


@cache
def motion(label):
    """The slider's velocity and acceleration under a torque on the crank."""
    torque, t_end = TORQUES[label]
    run = dx.simulate(
        torque=torque, t_end=t_end, names=("V_C", "a_C"), times=np.linspace(0.0, t_end, 2001),
        **MACHINE, **LINKS, **INERTIAS,
    )  # fmt: skip
    applied = [torque(t, 0.0, 0.0) if callable(torque) else torque for t in run["t"]]
    return {**run, "T_in": np.array(applied)}


def draw(number, ax=None):
    """One figure, under the name that the paper gives it; its Axes."""
    title, name, labels = FIGURES[number]
    axes = ax if ax is not None else Figure(figsize=(8.0, 4.8), layout="constrained").add_subplot()
    for label in labels:
        axes.plot(motion(label)["t"], motion(label)[name], label=label, linewidth=1.2)
    axes.set(xlabel="t [s]", ylabel=f"{name} [{UNITS[name]}]", xlim=(0.0, None))
    axes.set_title(f"Paper C, figure {number}: {title}", loc="left", fontsize="medium")
    axes.grid(True, color="0.9")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2, frameon=False)
    return axes


def main(folder):
    """Draw everything; a line for each file."""
    for number, (title, *_) in FIGURES.items():
        print(dx.plot.save(draw(number).figure, f"{folder}/paper_c_{number:02}.png"), "-", title)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
