"""Paper C by hand: every equation, the listing itself, the tables and captions of Gupta's report.

Frame. The paper counts torques anticlockwise and resolves forces along X and Y. No equation gives positions,
and the figures were not at hand. Used here: x along the slider axis from the crank centre to the slider, y to
the left of it, theta from +x towards +y; at theta = 0 the crank pin lies above the slider (the printed
R23y = +l sin(11.16 deg)/2 points from the rod's centre up to the crank), so the slider line is y = -e with
e = l sin(11.16 deg) = 0.06 m. With the force along negative X that gives the four static torques their signs.

To the package: its Y is this x, its X is this y; its theta and torques are the paper's (both turn from the
slider axis towards the other one: y F_X - x F_Y there is x F_y - y F_x here); ec = e, AB = r, BC = l,
branch = +1. `PACKAGE` maps the forces.
"""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

Symbols = Mapping[str, Any]

CRANK, ROD, ECCENTRICITY = 0.14, 0.31, 0.06  # m; the eccentricity from the angle 11.1599368 deg
CRANK_MASS, ROD_MASS, SLIDER_MASS = 0.7637, 1.559464, 1.95025  # kg
CRANK_INERTIA, ROD_INERTIA = 80.6e-6, 166.8085e-6  # kg m2, as listed
CRANK_ACCELERATION, FORCE = 76.663, 50.0  # rad/s2, N

# each package quantity as (unknown of the paper, sign); F14x is the friction that row 7 calls +-mu F14y
PACKAGE = {
    "T_in": ("T12", 1),
    "F_A_X": ("F12y", 1),
    "F_A_Y": ("F12x", 1),
    "F_B_X": ("F32y", -1),
    "F_B_Y": ("F32x", -1),
    "F_C_X": ("F43y", -1),
    "F_C_Y": ("F43x", -1),
    "N_C": ("F14y", 1),
    "F_friction": ("F14x", 1),
}

# --- Sec. 2: links 2, 3 and 4, each as left side less right side ----------------------------------


def link4_moment(v: Symbols) -> Any:
    """Link 4 about its centre of mass, N m; its inertia term is left out since alpha4 = 0."""
    guide = v["R14x"] * v["F14y"] - v["R14y"] * v["F14x"]
    joint = v["R34x"] * v["F43y"] - v["R34y"] * v["F43x"]
    force = v["RPx"] * v["FPy"] - v["RPy"] * v["FPx"]
    return guide - joint + force


# --- Sec. 2: the system ---------------------------------------------------------------------------

UNKNOWNS = ("F12x", "F12y", "F32x", "F32y", "F43x", "F43y", "F14y", "T12")
MATRIX = """\
1 0 1 0 0 0 0 0
0 1 0 1 0 0 0 0
-R12y R12x -R32y R32x 0 0 0 1
0 0 -1 0 1 0 0 0
0 0 0 -1 0 1 0 0
0 0 R23y -R23x -R43y R43x 0 0
0 0 0 0 -1 0 +-mu 0
0 0 0 0 0 -1 1 0""".splitlines()
RIGHT_HAND_SIDE = "[m2 aG2x, m2 aG2y, IG2 alpha2, m3 aG3x, m3 aG3y, IG3 alpha3, m4 aG4x - FPx, -FPy]"


def printed_matrix(v: Symbols, mu: Any = 0) -> list[list[Any]]:
    """The 8 by 8 matrix; `mu` carries the sign of the printed +-."""
    rows = (row.replace("+-", "").split() for row in MATRIX)
    return [[number(entry, {**v, "mu": mu}) for entry in row] for row in rows]


def printed_right_hand_side(v: Symbols) -> list[Any]:
    """The right-hand side, row by row."""
    products = re.sub(r"(?<=\w) (?=\w)", "*", RIGHT_HAND_SIDE.strip("[]"))
    return [number(entry, v) for entry in products.split(", ")]


# --- Sec. 2: the listing, its text as printed -----------------------------------------------------

LISTING = """\
%% Appropriate Link Dimensions and their Components
r = 0.14;
l= 0.31;
theta = 0;
R12x= r*cosd(theta)/2;
R12y= r*sind(theta)/2;
R32x= r*cosd(theta)/2;
R32y= r*sind(theta)/2;
R23x= l*cosd(11.1599368)/2;
R23y= l*sind(11.1599368)/2;
R43x= R23x;
R43y= R23y;
Fpx = 50;
%% Masses of all links
m2 = 0.7637;
m3 = 1.559464;
m4 = 1.95025;
%% Moment of inertias
IG2 = 80.6 *10^(-06);
IG3 = 166.8085 *10^(-06);
%% Angular accelerations
alpha2 = 76.663;
alpha3 = 35.29055;
%% Linear accelerations
aG2x= 0;
aG2y= 5.3665;
aG3x= 1.05855;
aG3y= 5.3665;
aG4x= 0;
syms F12x F12y F32x F32y F43x F43y F14y T12
A = [1 0 1 0 0 0 0 0;
      0 1 0 1 0 0 0 0;
     -R12y R12x -R32y -R32x 0 0 0 1;
      0 0 -1 0 1 0 0 0;
      0 0 0 -1 0 1 0 0;
      0 0 R23y -R23x -R43y R43x 0 0;
      0 0 0 0 -1 0 0 0;
      0 0 0 0 0 -1 1 0];
x = [F12x F12y F32x F32y F43x F43y F14y T12]';
B= [m2*aG2x m2*aG2y IG2*alpha2 m3*aG3x m3*aG3y IG3*alpha3 m4*aG4x-Fpx
0]';
x = pinv(A)*B
"""

FUNCTIONS = {
    "cosd": lambda deg: float(np.cos(np.radians(deg))),
    "sind": lambda deg: float(np.sin(np.radians(deg))),
}


def scalars(listing: str = LISTING) -> dict[str, Any]:
    """Every number that the listing assigns, in its own order: `name = expression;` lines, run as printed."""
    names: dict[str, Any] = {}
    for name, expression in re.findall(r"^(\w+) ?= ?([^\[\n]+);$", listing, re.MULTILINE):
        names[name] = number(expression, names)
    return names


def number(expression: str, names: Symbols) -> Any:
    """One MATLAB expression of the listing; `06` is a number there and not in Python."""
    python = re.sub(r"(?<![\d.])0+(?=\d)", "", expression.replace("^", "**"))
    return eval(python, dict(FUNCTIONS), dict(names))


def bracket(name: str, listing: str = LISTING) -> str:
    """The text between the brackets of `name = [...]`."""
    return re.search(rf"^{name} ?= ?\[([^\]]*)\]", listing, re.MULTILINE).group(1)


def rows(text: str, newline_ends_row: bool = True) -> list[list[str]]:
    """The entries of a MATLAB matrix; a semicolon ends a row, and so does a new line."""
    lines = re.split(r"[;\n]" if newline_ends_row else ";", text)
    return [line.split() for line in lines if line.strip()]


def run_listing(listing: str = LISTING) -> dict[str, Any]:
    """The listing's A, B (its broken line joined) and x = pinv(A)*B, with the numbers that led there."""
    names = scalars(listing)
    A = np.array([[number(entry, names) for entry in row] for row in rows(bracket("A", listing))], float)
    (entries,) = rows(bracket("B", listing), newline_ends_row=False)
    B = np.array([number(entry, names) for entry in entries], float)
    return names | {"A": A, "B": B, "x": np.linalg.pinv(A) @ B}


def changed(**lines: str) -> str:
    """The listing with some of its assignments replaced."""
    text = LISTING
    for name, expression in lines.items():
        text, count = re.subn(rf"^{name} ?= ?[^\[\n]+;$", f"{name} = {expression};", text, flags=re.MULTILINE)
        assert count == 1, name
    return text


ROW_3 = "-R12y R12x -R32y -R32x 0 0 0 1;"
CORRECTED_ROW_3 = "-R12y R12x -R32y +R32x 0 0 0 1;"


RIGHT = {
    "R12x": "-r*cosd(theta)/2",
    "R12y": "-r*sind(theta)/2",
    "R23x": "-l*cosd(11.1599368)/2",
    "R43x": "-R23x",
    "R43y": "-R23y",
    "Fpx": "-50",
}


def corrected_listing(**lines: str) -> str:
    """The listing with arms and signs put right."""
    return changed(**(RIGHT | lines)).replace(ROW_3, CORRECTED_ROW_3)


def line(name: str) -> str:
    """The line of the listing that assigns a name, as printed."""
    return re.search(rf"^{name} ?= ?.*;$", LISTING, re.MULTILINE).group()


HELD = {"alpha2": "0", "alpha3": "0", "aG2y": "0", "aG3x": "0", "aG3y": "0", "aG4x": "0"}
FREE = {
    "alpha3": "-35.29055",
    "aG3x": "-1.05855",
    "aG4x": "-2*1.05855",
    "IG2": "1758.882*10^(-06)",
    "IG3": "14559.335*10^(-06)",
}

# --- tables ---------------------------------------------------------------------------------------

STATIC_TORQUES = {0: -70.5, 90: -242.25, 180: 75.54, 270: 145.72}  # crank angle in deg: N mm

VALUES = {
    "F12x": "-48.3136",
    "F12y": "7.1431",
    "F32x": "-48.3136",
    "F32y": "-3.0447",
    "F43x": "50.00",
    "F43y": "5.1434",
    "F14x": "5.1434",
    "T12": "-0.07070",
}

# --- Sec. 3 ---------------------------------------------------------------------------------------


def printed_sinusoid(t: Any, cos: Any) -> Any:
    """T = 350*(1 - cos(30t)), N mm; `cos` decides whether 30t is in radians or degrees."""
    return 350 * (1 - cos(30 * t))


TORQUES = {"3.1.1": 250, "3.2.2": 500}  # N mm, constant

SENTENCES = (  # of Sec. 1, Sec. 3 and Sec. 3 again
    "A force of 50N was applied on point A in the global negative-X direction.",
    "a torque of 250 N mm was applied on the crank AB to get the required percentage increment in the"
    " velocity.",
    "Velocity and acceleration plots of output A are plotted for both 250 and 500 N mm",
)

CONTENTS = {
    "1": "Static Force Analysis",
    "2": "Validation of Static Force Analysis",
    "3": "Dynamic Motion Analysis",
    "3.1": "Constant Driving Force/Torque",
    "3.1.1": "Plots for 250 N-mm Torque",
    "3.1.2": "Doubled Constant Torque",
    "3.2": "Sinusoidal Driving Force",
}

HEADINGS = (
    ("1", "Static Force Analysis"),
    ("2", "Validation of Static Force Analysis"),
    ("3", "Dynamic Motion Analysis"),
    ("3.1", "Constant Driving Torque"),
    ("3.1.1", "Plots for 250 N mm torque"),
    ("3.2.2", "Doubled Constant Torque"),
    ("3.1", "Constant Driving Torque"),
)

BLUE = "(Here, blue indicates plot for 500 N mm)"

FIGURES = {  # number: (in the table of figures, under the figure)
    1: ("Static Force Analysis at 0deg", "Static Force Analysis at 0deg"),
    2: ("Static Force Analysis at 90deg", "Static Force Analysis at 90deg"),
    3: ("Static Force Analysis at 180deg", "Static Force Analysis at 180deg"),
    4: ("Static Force Analysis at 270deg", "Static Force Analysis at 270deg"),
    5: ("X-Component of Velocity of Slider D", "X-Direction Velocity of Output (Slider D)"),
    6: ("X-Component of Acceleration of Slider D", "X-Direction Acceleration of Output (Slider D)"),
    7: ("X-Component of Velocity of Slider D", "X-Direction Velocity of Output (Slider D)"),
    8: ("X-Component of Acceleration of Slider D", "X-Direction Acceleration of Output (Slider D)"),
    9: ("Sinusoidal Torque on input crank", "Sinusoidal Torque on input crank"),
    10: ("X-Component of Velocity of Slider D", "X-Direction Velocity of Output (Slider D)"),
    11: ("X-Component of Acceleration of Slider D", "X-Direction Acceleration of Output (Slider D)"),
}
