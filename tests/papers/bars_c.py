"""The links of paper C reconstructed: steel bars whose masses and inertias are the printed digits.

The report prints no section. Bars of 30 x 20 mm with rounded ends about their joints, drawn as polygons as a
faceted solid model has them, have its masses to all digits, and its moments of inertia about their own long
axes.
"""

import math

from mpmath import mpf

from tests.papers import paper_c as C
from tests.papers.states_c import report

DENSITY, WIDTH, DEPTH, FACETS = 7801.0, 0.030, 0.020, 20  # steel, kg/m3; m, m; sides of the polygon
ROUND = 20000  # facets that are as good as round
BARS = {"2": C.CRANK, "3": C.ROD}


def outline(length, facets=FACETS):
    """Corners of a bar whose ends are half polygons about its joints, anticlockwise, m."""
    turn = [math.pi * (n / (facets / 2) - 0.5) for n in range(facets // 2 + 1)]
    end = [(length / 2 + WIDTH / 2 * math.cos(t), WIDTH / 2 * math.sin(t)) for t in turn]
    return end + [(-x, -y) for x, y in end]


def bar(length, facets=FACETS):
    """Mass, moment of inertia about the long axis and about z, kg and kg m2."""
    area = long = across = 0.0
    corners = outline(length, facets)
    for (x, y), (p, q) in zip(corners, corners[1:] + corners[:1], strict=True):
        cross = x * q - p * y
        area += cross / 2
        long += cross * (y * y + y * q + q * q) / 12
        across += cross * (x * x + x * p + p * p) / 12
    sheet = DENSITY * DEPTH
    return sheet * area, sheet * (long + area * DEPTH**2 / 12), sheet * (long + across)


def reconstructed(**changes):
    """The report's mechanism with the moments of inertia of the reconstructed bars about z."""
    return report(I_crank=bar(C.CRANK)[2], I_rod=bar(C.ROD)[2], **changes)


def thin_rod(**changes):
    """The report's mechanism with the moments of inertia of thin rods about z."""
    masses = {"I_crank": (C.CRANK_MASS, C.CRANK), "I_rod": (C.ROD_MASS, C.ROD)}
    return report(**{name: mpf(m) * mpf(length) ** 2 / 12 for name, (m, length) in masses.items()}, **changes)
