"""Redraw figures 5 to 18 of paper B (Obaseki and Alfred) into a folder.

    python examples/paper_b.py out/

The paper calls AB, BC, ec, phi, Y by k, c, e, alpha, x, measures s = k + c - x, and counts the slider's
velocity and acceleration as those of s. Solid curves are the mechanism's own; dashed ones are the paper's
torque (48), with the wrong lever (docs/ERRATA.md has more), and its existing model (52), (53).
"""

import sys
from functools import cache

import numpy as np
from matplotlib.figure import Figure

import desaxe as dx

SPEED = 251.327  # rad/s, 2400 rev/min
SIZES = {"AB": 0.040, "BC": 0.064, "omega0": SPEED}  # Table 1
MASSES = {"m_crank": 0.2, "m_rod": 0.5, "m_slider": 0.8, "I_rod": 0.5 * 0.064**2 / 12}  # uniform links
OFFSET, OFFSETS = 0.020, (0.0, 0.010, 0.020)  # m: figures 5 to 14, and 15 and 16
THETA = np.linspace(0.0, 4 * np.pi, 1441)  # two turns
TIME = THETA / SPEED

FIGURES = {
    5: "Stroke-time graph",
    6: "Stroke versus crank angle graph",
    7: "Velocity-time graph of slider block",
    8: "Acceleration-time graph of slider block",
    9: "Velocity-time graph of connecting rod",
    10: "Acceleration-time graph for connecting rod",
    11: "Horizontal reaction force at the crank pin, (38)",
    12: "Horizontal [vertical] reaction force at the crank pin, (39)",
    13: "Total inertia force on the mechanism, (46)",
    14: "Total torque on the mechanism",
    15: "Effect of offset distance on acceleration of slider",
    16: "Effect of offset distance on total torque",
    17: "Comparing acceleration with existing model",
    18: "Comparing torque with existing model at e = 0 mm",
}


@cache
def courses(ec):
    """What figures 5 to 14 and 17 and 18 show, in the package's names, over THETA."""
    names = ["phi", "V_C", "a_C", "omega_BC", "alpha_BC", "a_B_X", "a_B_Y", "T_in", "F_shaking_Y"]
    return dx.evaluate([*names, "m_rotating", "Y"], theta=THETA, ec=ec, **SIZES, **MASSES)


def drawn_over(number):
    """Horizontal values and label, and the curves by label, of a figure that has no family."""
    one = courses(OFFSET)
    stroke = SIZES["AB"] + SIZES["BC"] - one["Y"]
    table = {
        5: {"s [m]": stroke},
        6: {"s [m]": stroke},
        7: {"v_s [m/s]": -one["V_C"]},
        8: {"a_s [m/s²]": -one["a_C"]},
        9: {"v_c [rad/s]": one["omega_BC"]},
        10: {"a_c [rad/s²]": one["alpha_BC"]},
        11: {"R_x [N]": one["m_rotating"] * one["a_B_Y"]},
        12: {"R_y [N]": one["m_rotating"] * one["a_B_X"]},
        13: {"F_I [N]": one["F_shaking_Y"]},
        14: {
            "T_in [N m]": one["T_in"],
            "(48)": SIZES["AB"] * one["F_shaking_Y"] * np.tan(one["phi"]),
        },
        17: {"a_C [m/s²]": courses(0.0)["a_C"], "(52)": existing_acceleration()},
        18: {"T_in [N m]": courses(0.0)["T_in"], "(53), drawn negative": -existing_torque()},
    }
    across = (np.degrees(THETA), "theta [deg]") if number == 6 else (TIME, "t [s]")
    return *across, table[number]


def existing_acceleration():
    """(52), with its delta as k/c."""
    k, c = SIZES["AB"], SIZES["BC"]
    return -k * SPEED**2 * (np.cos(THETA) + k / c * np.cos(2 * THETA))


def existing_torque():
    """(53)."""
    k, c = SIZES["AB"], SIZES["BC"]
    m3 = dx.evaluate("m_reciprocating", BC=c, m_rod=MASSES["m_rod"], m_slider=MASSES["m_slider"])
    series = k / c * np.sin(THETA) / 4 - np.sin(2 * THETA) / 2 - 3 * k / c * np.sin(3 * THETA) / 4
    return m3 * k**2 * SPEED**2 * series


def draw(number, ax=None):
    """One figure; its Axes."""
    if number in (15, 16):
        many = dx.grid(["a_C", "T_in"], ec=np.array(OFFSETS), theta=THETA, **SIZES, **MASSES)
        axes = dx.plot.curves(many, "a_C" if number == 15 else "T_in", ax=ax)[0].axes
        offset = ""
    else:
        axes = plain(*drawn_over(number), ax)
        offset = f", e = {1e3 * OFFSET:.0f} mm" if number <= 14 else ", e = 0 mm" if number == 17 else ""
    axes.set_title(f"Paper B, figure {number}: {FIGURES[number]}{offset}", loc="left", fontsize="medium")
    return axes


def plain(across, unit, curves, ax):
    """Curves over time or angle, the second one dashed; the Axes."""
    axes = ax if ax is not None else Figure(figsize=(8.0, 4.8), layout="constrained").add_subplot()
    for (label, course), style in zip(curves.items(), ("-", "--"), strict=False):
        axes.plot(across, course, style, label=label)
    axes.set(xlabel=unit, ylabel=next(iter(curves)), xlim=(across[0], across[-1]))
    axes.grid(True, color="0.9")
    if len(curves) > 1:
        axes.legend(framealpha=0.9)
    return axes


def main(folder):
    """Draw everything; a line for each file."""
    for number, title in FIGURES.items():
        print(dx.plot.save(draw(number).figure, f"{folder}/paper_b_{number:02}.png"), "-", title)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
