"""Redraw figures 5 to 11 of paper C (Gupta) into a folder.

    python examples/paper_c.py out/

The paper's X runs along the slider axis, as Y does here: its X-direction velocity and acceleration of the
slider are V_C and a_C. The motion starts from rest at theta = 0.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

import desaxe as dx

MACHINE = {"AB": 0.14, "BC": 0.31, "ec": 0.06}  # m; r, l, e
LINKS = {"m_crank": 0.7637, "m_rod": 1.559464, "m_slider": 1.95025}  # kg; centres of mass in the middle
INERTIAS = {"I_crank": 80.6e-6, "I_rod": 166.8085e-6}  # kg m2


def main(folder: str) -> None:
    """Draw everything; a line for each file."""
    single, double = motion(0.25, 2.25), motion(0.5, 2.25)
    wavy = motion(wave, 2.0)
    draw(folder, 5, "X-Component of Velocity of Slider D", "V_C", "m/s", {"250 N mm": single})
    draw(folder, 6, "X-Component of Acceleration of Slider D", "a_C", "m/s²", {"250 N mm": single})
    both = {"250 N mm": single, "500 N mm": double}
    draw(folder, 7, "X-Component of Velocity of Slider D", "V_C", "m/s", both)
    draw(folder, 8, "X-Component of Acceleration of Slider D", "a_C", "m/s²", both)
    times = wavy["t"]
    torque = {"t": times, "T_in": np.array([wave(t, 0.0, 0.0) for t in times])}
    draw(folder, 9, "Sinusoidal Torque on input crank", "T_in", "N m", {"350 (1 - cos 30 t) N mm": torque})
    draw(folder, 10, "X-Component of Velocity of Slider D", "V_C", "m/s", {"350 (1 - cos 30 t) N mm": wavy})
    draw(
        folder,
        11,
        "X-Component of Acceleration of Slider D",
        "a_C",
        "m/s²",
        {"350 (1 - cos 30 t) N mm": wavy},
    )


def wave(t: float, theta: float, omega: float) -> float:
    """The torque of section 3.2 [N m]."""
    return 0.35 * (1.0 - np.cos(30.0 * t))


def motion(torque, t_end):
    """The slider's velocity and acceleration under a torque on the crank."""
    return dx.simulate(
        torque=torque, t_end=t_end, names=("V_C", "a_C"), times=np.linspace(0.0, t_end, 2001),
        **MACHINE, **LINKS, **INERTIAS,
    )  # fmt: skip


def draw(folder, number, title, name, unit, courses):
    """Courses over time under the name that the paper gives the figure."""
    axes = Figure(figsize=(8.0, 4.8), layout="constrained").add_subplot()
    for label, course in courses.items():
        axes.plot(course["t"], course[name], label=label, linewidth=1.2)
    axes.set(xlabel="t [s]", ylabel=f"{name} [{unit}]", xlim=(0.0, None))
    axes.set_title(f"Paper C, figure {number}: {title}", loc="left")
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    print(dx.plot.save(axes.figure, f"{folder}/paper_c_{number:02}.png"), "-", title)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
