"""Redraw figures 5 to 18 of paper B (Obaseki and Alfred) into a folder.

    python examples/paper_b.py out/

The paper calls AB, BC, ec, phi, Y by k, c, e, alpha, x, measures s = k + c - x, and counts the slider's
velocity and acceleration as those of s. Solid curves are the mechanism's own; dashed ones are the paper's
torque (48), with the wrong lever (`desaxe errata --document B` has more), and its existing model (52), (53).
"""

import sys

import numpy as np
from matplotlib.figure import Figure

import desaxe as dx

SPEED = 251.327  # rad/s, 2400 rev/min
SIZES = {"AB": 0.040, "BC": 0.064, "omega0": SPEED}  # Table 1
MASSES = {"m_crank": 0.2, "m_rod": 0.5, "m_slider": 0.8, "I_rod": 0.5 * 0.064**2 / 12}  # uniform links
OFFSETS = [0.0, 0.010, 0.020]
THETA = np.linspace(0.0, 4 * np.pi, 1441)  # two turns
TIME = THETA / SPEED


def main(folder: str) -> None:
    """Draw everything; a line for each file."""
    one = dx.evaluate(
        ["phi", "V_C", "a_C", "omega_BC", "alpha_BC", "a_B_X", "a_B_Y", "T_in", "F_shaking_Y", "m_rotating"],
        theta=THETA, ec=0.020, **SIZES, **MASSES,
    )  # fmt: skip
    stroke = SIZES["AB"] + SIZES["BC"] - dx.evaluate("Y", theta=THETA, ec=0.020, AB=0.040, BC=0.064)
    torque = SIZES["AB"] * one["F_shaking_Y"] * np.tan(one["phi"])  # (48)

    figures = {
        5: ("Stroke-time graph", TIME, "t [s]", {"s [m]": stroke}),
        6: ("Stroke versus crank angle graph", np.degrees(THETA), "theta [deg]", {"s [m]": stroke}),
        7: ("Velocity-time graph of slider block", TIME, "t [s]", {"v_s [m/s]": -one["V_C"]}),
        8: ("Acceleration-time graph of slider block", TIME, "t [s]", {"a_s [m/s²]": -one["a_C"]}),
        9: ("Velocity-time graph of connecting rod", TIME, "t [s]", {"v_c [rad/s]": one["omega_BC"]}),
        10: ("Acceleration-time graph for connecting rod", TIME, "t [s]", {"a_c [rad/s²]": one["alpha_BC"]}),
        11: ("Horizontal reaction force at the crank pin, (38)", TIME, "t [s]",
             {"R_x [N]": one["m_rotating"] * one["a_B_Y"]}),
        12: ("Horizontal [vertical] reaction force at the crank pin, (39)", TIME, "t [s]",
             {"R_y [N]": one["m_rotating"] * one["a_B_X"]}),
        13: ("Total inertia force on the mechanism, (46)", TIME, "t [s]", {"F_I [N]": one["F_shaking_Y"]}),
        14: ("Total torque on the mechanism", TIME, "t [s]", {"T_in [N m]": one["T_in"], "(48)": torque}),
    }  # fmt: skip
    for number, (title, across, unit, courses) in figures.items():
        save(folder, number, title, plain(across, unit, courses))

    many = dx.grid(["a_C", "T_in"], ec=OFFSETS, theta=THETA, **SIZES, **MASSES)
    for number, name, title in (
        (15, "a_C", "Effect of offset distance on acceleration of slider"),
        (16, "T_in", "Effect of offset distance on total torque"),
    ):
        save(folder, number, title, dx.plot.curves(many, name)[0].axes)

    centric = dx.evaluate(["a_C", "T_in"], theta=THETA, ec=0.0, **SIZES, **MASSES)
    k, c = SIZES["AB"], SIZES["BC"]
    m3 = dx.evaluate("m_reciprocating", BC=c, m_rod=0.5, m_slider=0.8)
    existing = -k * SPEED**2 * (np.cos(THETA) + k / c * np.cos(2 * THETA))  # (52)
    series = k / c * np.sin(THETA) / 4 - np.sin(2 * THETA) / 2 - 3 * k / c * np.sin(3 * THETA) / 4
    pairs = {
        17: ("Comparing acceleration with existing model", {"a_C [m/s²]": centric["a_C"], "(52)": existing}),
        18: ("Comparing torque with existing model at e = 0 mm",
             {"T_in [N m]": centric["T_in"], "(53), drawn negative": -m3 * k**2 * SPEED**2 * series}),
    }  # fmt: skip
    for number, (title, courses) in pairs.items():
        save(folder, number, title, plain(TIME, "t [s]", courses))


def plain(across, unit, courses):
    """Courses over time or angle, the second one dashed; the Axes."""
    axes = Figure(figsize=(8.0, 4.8), layout="constrained").add_subplot()
    for (label, course), style in zip(courses.items(), ("-", "--"), strict=False):
        axes.plot(across, course, style, label=label)
    axes.set(xlabel=unit, ylabel=next(iter(courses)), xlim=(across[0], across[-1]))
    axes.grid(True, color="0.9")
    if len(courses) > 1:
        axes.legend(frameon=False)
    return axes


def save(folder, number, title, axes):
    """Write the figure under the name that the paper gives it."""
    axes.set_title(f"Paper B, figure {number}: {title}", loc="left")
    print(dx.plot.save(axes.figure, f"{folder}/paper_b_{number:02}.png"), "-", title)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
