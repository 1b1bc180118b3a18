"""Paper C, Sec. 1: the static torques, the readings that were tried, and the weights."""

import itertools
import math
import re

import numpy as np
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.designs import close
from tests.papers.proofs import proves, proves_each
from tests.papers.states_c import STATES, at_rest, report, symbols

PRINTED = np.array(list(C.STATIC_TORQUES.values()))  # N mm
ANGLES = np.radians(list(C.STATIC_TORQUES))
LENGTHS = {"AB": 1e3 * C.CRANK, "BC": 1e3 * C.ROD}  # mm: torques in N mm


def held(degrees, **changes):
    """T12, N mm, that holds the report's mechanism, by virtual work and by the eight equations."""
    state = report(theta=mp.radians(degrees), **changes)
    torque = 1000 * ne.holding_torque(state)
    assert close(1000 * ne.solve(state)["T12"], torque, 1, 30)
    return torque


@proves_each(
    {f"C-static-{degrees}": degrees for degrees in C.STATIC_TORQUES},
    "not reproducible",
    says={f"C-static-{degrees}": f"{degrees} {torque}" for degrees, torque in C.STATIC_TORQUES.items()},
)
def test_static_torque(degrees):
    """Against the torque that holds 50 N along -X: by virtual work, the eight equations and the package."""
    torque = held(degrees)
    state = report(theta=math.radians(degrees))
    assert close(1000 * mpf(dx.evaluate("T_in", **state._asdict())), torque, 0, 10)
    data = [mpf(50), mpf(C.CRANK), mpf(C.ROD), mpf(C.ECCENTRICITY)]
    return {"held": torque, "data": data, "ratio": torque / mpf(C.STATIC_TORQUES[degrees])}


def reach(ec, tilt=0.0):
    """dx/dtheta of the slider and the rod's slope at the four angles; tilt: of the slider axis."""
    theta = ANGLES - tilt
    side = ec + LENGTHS["AB"] * np.sin(theta)
    along = np.sqrt(LENGTHS["BC"] ** 2 - side**2)
    return -LENGTHS["AB"] * (np.sin(theta) + side * np.cos(theta) / along), -side / along


def misfit(torque_per_newton):
    """The residual of the printed torques for the best force, N mm, and that force, N."""
    force = torque_per_newton @ PRINTED / (torque_per_newton @ torque_per_newton)
    return float(np.linalg.norm(force * torque_per_newton - PRINTED)), float(force)


def by_offset(offsets):
    """The best force along X for the best of some offsets."""
    return min(misfit(-reach(ec)[0]) for ec in offsets)


def by_friction():
    """T = -F dx/dtheta / (1 - s mu slope): each position on either limit of friction, any mu."""
    return min(
        misfit(-speed / (1 - mu * np.array(sides) * slope))
        for ec in (60.0, -60.0)
        for mu in np.linspace(0.0, 1.1, 111)
        for speed, slope in [reach(ec)]
        for sides in itertools.product((1, -1), repeat=4)
    )


def by_tilt():
    """Crank angles counted from any other direction than the slider axis."""
    tilts = np.linspace(-np.pi, np.pi, 3601)
    return min(misfit(-reach(ec, tilt)[0]) for ec in (60.0, -60.0) for tilt in tilts)


def shown(result):
    """A force's size and what it leaves."""
    return [mpf(abs(result[1])), mpf(result[0])]


def four_free_numbers():
    """Force, rod, offset and tilt all free do fit, on the edge of assembly: not the report's mechanism."""
    force, rod, ec, tilt = -1.0428343400323759, 260.96813778554116, 120.85286011922257, 0.022403868254254933
    theta = ANGLES - tilt
    side = ec + LENGTHS["AB"] * np.sin(theta)
    speed = -LENGTHS["AB"] * (np.sin(theta) + side * np.cos(theta) / np.sqrt(rod**2 - side**2))
    assert np.allclose(-force * speed, PRINTED, rtol=0, atol=1e-6)
    assert abs(rod - LENGTHS["BC"]) > 45
    free = [mpf(-force), mpf(rod), mpf(ec), mp.degrees(mpf(tilt))]
    return {"free": free, "margin": mpf(rod - LENGTHS["AB"] - ec)}


@proves(
    "C-static-table", "not reproducible", says="-70.5, -242.25, 75.54, 145.72 N mm at 0, 90, 180, 270 deg"
)
def test_opposite_angles_need_opposite_torques():
    """Constant forces anywhere, any lengths and masses: T(0) = -T(180) and T(90) = -T(270)."""
    for number, state in enumerate(map(at_rest, STATES[:8])):
        longer = state._replace(ec=0.3 * (-1) ** number, AB=0.2, BC=0.2 + 0.3 + 0.1 * (number + 1))
        torques = [ne.holding_torque(longer._replace(theta=mp.pi * quarter / 2)) for quarter in range(4)]
        sums = abs(torques[0] + torques[2]) + abs(torques[1] + torques[3])
        assert sums < mpf(10) ** -30 * max(map(abs, torques))
        assert min(map(abs, torques)) > 0
    for ec, degrees in itertools.product((60.0, -60.0), C.STATIC_TORQUES):  # the fast reach is the loop's
        true = ne.by_theta(ne.slider, report(theta=math.radians(degrees), ec=ec / 1000))[1][0]
        assert abs(reach(ec)[0][list(C.STATIC_TORQUES).index(degrees)] / 1000 - true) < 1e-14
    pairs = [mpf(float(PRINTED[n] + PRINTED[n + 2])) for n in (0, 1)]
    assert abs(pairs[0] - pairs[1]) > 100  # nor does a constant torque on top explain both
    ratios = [mpf(float(one)) / held(degrees) for one, degrees in zip(PRINTED, C.STATIC_TORQUES, strict=True)]
    below, above = by_offset([60.0]), by_offset([-60.0])
    return four_free_numbers() | {
        "sums": pairs,
        "least": mp.sqrt((pairs[0] ** 2 + pairs[1] ** 2) / 2),
        "held": [held(degrees) for degrees in C.STATIC_TORQUES],
        "size": mpf(float(np.linalg.norm(PRINTED))),
        "below": [mpf(60), *shown(below)],
        "above": [mpf(-60), *shown(above)],
        "any": shown(by_offset(np.linspace(-169.5, 169.5, 3391))),
        "friction": shown(by_friction()),
        "tilt": shown(by_tilt()),
        "spread": max(ratios) / min(ratios),
        "names": {"T": lambda angle: held(angle, ec=0.03)},
    }


WEIGHTS = f"m2 = {C.CRANK_MASS}; m3 = {C.ROD_MASS}; m4 = {C.SLIDER_MASS}; A force of 50N was applied"


def held_by_the_printed_matrix(weights):
    """T12, N mm, at 0 deg at rest, with these terms on the right of the rows along Y."""
    v = symbols(report())
    right = [0, weights[0], 0, 0, weights[1], 0, -v["FPx"], weights[2]]
    return 1000 * mp.lu_solve(mp.matrix(C.printed_matrix(v)), mp.matrix(right))[7]


@proves("C-weights", "omission", says=WEIGHTS, cites="2 5 8 C-static-table")
def test_weights_are_left_out():
    """Held at 0 deg against gravity along -Y the weights ask for more than the load, the other way round."""
    g = mpf("9.81")
    weights = [g * mpf(mass) for mass in (C.CRANK_MASS, C.ROD_MASS, C.SLIDER_MASS)]
    alone, load, both = held(0, g_X=-g, F_Y=0.0), held(0), held(0, g_X=-g)
    assert close(alone + load, both, 0, 25)
    by_matrix = [held_by_the_printed_matrix([sign * weight for weight in weights]) for sign in (1, 0, -1)]
    assert all(close(result, want, 0, 25) for result, want in zip(by_matrix, (both, load), strict=False))
    v = symbols(report(g_X=-g, F_X=3.0))
    sums = {"crank": v["F12y"] + v["F32y"], "rod": v["F43y"] - v["F32y"], "slider": v["F14y"] - v["F43y"]}
    return sums | {
        "total": sum(weights),
        "weights": weights,
        "force": mpf(50),
        "alone": alone,
        "load": load,
        "both": both,
        "reversed": by_matrix[2],
        "names": v | {"g": g},
    }


@proves("C-point-A", "typo")
def test_point_A_is_two_points():
    """Force and output are at A, an end of "crank AB"; at either end 50 N along X need no torque at 0 deg."""
    named = [re.findall(r"(point|output|crank) (A\w?)", sentence) for sentence in C.SENTENCES]
    assert named == [[("point", "A")], [("crank", "AB")], [("output", "A")]]
    assert all("Slider D" in C.FIGURES[number][1] for number in (5, 6, 7, 8, 10, 11))
    assert abs(ne.by_theta(ne.pin, report())[1][0]) < mpf(10) ** -30
    assert abs(ne.by_theta(ne.slider, report())[1][0]) > 0.02
    return {"angle": mpf(0), "printed_torque": mpf(C.STATIC_TORQUES[0])}
