"""Averages over the turn, values at an angle and functions as measures of designs."""

from itertools import pairwise

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from desaxe.design.measures import checked, measured

MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8, "m_rod": 0.5}
MEASURES = [
    ("rms", "T_in"),
    ("at", "60 deg", "a_C"),
    *(pytest.param(m, marks=pytest.mark.thorough) for m in (("mean", "power_in"), ("rms", "F_B"))),
]


@pytest.mark.parametrize("measure", MEASURES, ids=str)
def test_values_and_derivatives(measure):
    ec = np.array([0.0, 0.03, 0.1])
    result = measured([checked(measure)], {**MACHINE, "ec": ec})[checked(measure)]
    theta = np.linspace(0, 2 * np.pi, 4096, endpoint=False) if measure[0] != "at" else np.array([np.pi / 3])
    values = dx.evaluate(measure[-1], theta=theta, ec=ec[:, None], **MACHINE)
    expected = np.sqrt((values**2).mean(1)) if measure[0] == "rms" else values.mean(1)
    scale = np.abs(values).max()
    assert np.allclose(result.value, expected, rtol=1e-11, atol=1e-11 * scale)
    step = 1e-6
    sides = [measured([checked(measure)], {**MACHINE, "ec": ec + s})[checked(measure)] for s in (-step, step)]
    slope = (sides[1].value - sides[0].value) / (2 * step)
    assert np.allclose(result.gradient["ec"], slope, rtol=1e-6, atol=1e-6 * scale)


def test_optimize_takes_them_and_functions():
    over, keep = {"ec": (0.0, 0.1)}, {"stroke": (0.25, 0.26)}
    best = dx.optimize(minimize=("rms", "T_in"), over=over, keep=keep, **MACHINE)
    assert best["status"] == 0
    trial = np.linspace(0.0, 0.1, 41)
    others = measured([("rms", "T_in"), "stroke"], {**MACHINE, "ec": trial})
    allowed = (others["stroke"].value >= 0.25) & (others["stroke"].value <= 0.26)
    assert best["value"] <= others[("rms", "T_in")].value[allowed].min() * (1 + 1e-9)

    def parabola(design):
        return (design["ec"] - 0.04) ** 2, {"ec": 2 * (design["ec"] - 0.04)}

    assert dx.optimize(minimize=parabola, over=over, **MACHINE)["ec"] == pytest.approx(0.04, abs=1e-7)
    own = dx.define("loss", "abs(N_C * V_C)")
    try:
        best = dx.optimize(minimize=("mean", own), over={"ec": (0.0, 0.1)}, **MACHINE)
        assert 0.0 <= best["ec"] <= 0.1
        assert best["value"] > 0
    finally:
        dx.undefine(own)


# Slider and massless rod next to a change point or not, by their free bodies with 40 digits.
DIGITS, NODES = 40, 30
TABLE = [0.5, 2.0, 4.0], [-20.0, -90.0, 30.0]
LOADS = {
    "number": -50.0,
    "smooth": dx.over_theta(lambda theta: -60.0 * np.sin(theta) ** 2),
    "kink": dx.over_theta(*TABLE, kind="linear"),
    "jump": dx.over_theta(*TABLE, kind="step"),
    "jump over Y": dx.over_Y([0.0, 0.21, 1.0], [-70.0, -10.0, -10.0], kind="step"),
    "jump over the stroke": dx.over_stroke(
        [0.0, 0.08, 0.08, 1.0], [-70.0, -70.0, 0.0, 0.0], dead_centre="outer"
    ),
}


class Bodies:
    """The truth of a design: positions, forces, and integrals between all angles at which these change."""

    def __init__(self, load, design):
        self.load = load
        self.ec, self.AB, self.BC, self.w, self.m, self.mu = (
            mpf(design[n]) for n in ("ec", "AB", "BC", "omega0", "m_slider", "mu")
        )
        self.outer = mp.sqrt((self.AB + self.BC) ** 2 - self.ec**2)

    def motion(self, theta):
        """u, the rod's height, Y, Y' and the acceleration."""
        u, bend, slope = self.ec + self.AB * mp.sin(theta), -self.AB * mp.sin(theta), self.AB * mp.cos(theta)
        C = mp.sqrt(self.BC**2 - u**2)
        Y2 = -slope - (slope**2 + u * bend) / C - (u * slope) ** 2 / C**3
        return u, C, self.AB * mp.cos(theta) + C, bend - u * slope / C, self.w**2 * Y2

    def force(self, theta, inside):
        """The load at an angle, of the piece at the angle `inside`."""
        if self.load in ("number", "smooth"):
            return mpf(-50) if self.load == "number" else -60 * mp.sin(theta) ** 2
        if self.load == "jump over Y":
            return mpf(-70) if self.motion(inside)[2] < mpf(0.21) else mpf(-10)
        if self.load == "jump over the stroke":
            return mpf(-70) if self.outer - self.motion(inside)[2] < mpf(0.08) else mpf(0)
        angles, values = ([mpf(v) for v in column] for column in TABLE)
        angles, values = [*angles, angles[0] + 2 * mp.pi], [*values, values[0]]
        shift = 0 if inside > angles[0] else 2 * mp.pi
        k = next(k for k in range(3) if inside + shift < angles[k + 1])
        if self.load == "jump":
            return values[k]
        share = (theta + shift - angles[k]) / (angles[k + 1] - angles[k])
        return values[k] + share * (values[k + 1] - values[k])

    def side(self, theta):
        """The sign of friction on an arc, and of the rod's force there."""
        _, _, _, slope, a = self.motion(theta)
        return mp.sign(self.force(theta, theta) - self.m * a) * mp.sign(slope * self.w)

    def forces(self, theta, inside, side):
        """T_in and N_C: f u and -f C is the rod's force on the slider."""
        u, C, _, slope, a = self.motion(theta)
        f = (self.force(theta, inside) - self.m * a) / (C + self.mu * abs(u) * side)
        return {"T_in": -f * C * slope, "N_C": -f * u}

    def edges(self):
        """Dead centres, sides of the guide, ends of pieces, and angles graded towards the near quarter."""
        quarter, width = mp.pi / 2, mp.sqrt((self.BC - self.AB - abs(self.ec)) / self.BC) / 8
        steps = [width * mpf(3) ** k for k in range(40) if width * mpf(3) ** k < quarter]
        known = [mpf(0), quarter, 2 * mp.pi, *(mp.pi + k * quarter / 3 for k in range(6))]
        known += [quarter + side * step for step in steps for side in (-1, 1)]
        pieces = [mpf(v) for v in TABLE[0]] if self.load in ("kink", "jump") else []
        inside = sorted({*known, *pieces})
        at_step = {
            "jump over Y": lambda t: self.motion(t)[2] - mpf(0.21),
            "jump over the stroke": lambda t: self.outer - self.motion(t)[2] - mpf(0.08),
        }
        functions = [lambda t: self.motion(t)[0], lambda t: self.motion(t)[3]]
        functions += [at_step[self.load]] if self.load in at_step else []
        first = sorted({*inside, *self.roots(functions, inside)})
        balance = [
            lambda t, b=(a + b) / 2: self.force(t, b) - self.m * self.motion(t)[4] for a, b in pairwise(first)
        ]
        for function, ends in zip(balance, pairwise(first), strict=True):
            inside += self.roots([function], ends)
        return sorted({*inside, *first})

    def roots(self, functions, angles):
        return [
            mp.findroot(f, (a, b), solver="anderson", tol=1e-60, verify=False)
            for f in functions for a, b in pairwise(angles) if f(a) * f(b) < 0
        ]  # fmt: skip

    def figures(self):
        """Mean and mean square of T_in and N_C, cos and sin of the first harmonic and the work of T_in."""
        sums = dict.fromkeys(
            ("mean T_in", "square T_in", "mean N_C", "square N_C", "cos", "sin", "work"), mpf(0)
        )
        for a, b in pairwise(self.edges()):
            side = self.side((a + b) / 2)
            for node, weight in RULE:
                theta, share = (a + b) / 2 + (b - a) / 2 * node, weight * (b - a) / 2
                for name, value in self.forces(theta, (a + b) / 2, side).items():
                    sums[f"mean {name}"] += share * value / (2 * mp.pi)
                    sums[f"square {name}"] += share * value**2 / (2 * mp.pi)
                    if name == "T_in":
                        sums["cos"] += share * value * mp.cos(theta) / mp.pi
                        sums["sin"] += share * value * mp.sin(theta) / mp.pi
                        sums["work"] += share * max(value, 0)
        return sums


def _rule():
    with mp.workdps(DIGITS + 10):
        guesses = np.polynomial.legendre.leggauss(NODES)[0]
        nodes = [mp.findroot(lambda x: mp.legendre(NODES, x), mpf(guess)) for guess in guesses]
        slopes = [NODES * mp.legendre(NODES - 1, x) / (1 - x**2) for x in nodes]
        return [(x, 2 / ((1 - x**2) * slope**2)) for x, slope in zip(nodes, slopes, strict=True)]


RULE = _rule()


def cells():
    """Loads, each smooth and with friction, some way from the change point and next to it."""
    for load in LOADS:
        for margin in (0.08, 1e-3, 1e-6, 1e-8, 1e-10):
            for friction in (False, True):
                default = (margin == 0.08 and friction and load in ("smooth", "kink")) or (
                    margin == 1e-8 and load == "jump over Y" and friction
                )
                marks = [] if default else [pytest.mark.thorough]
                yield pytest.param(load, margin, friction, marks=marks, id=f"{load}-{margin}-{friction}")


@pytest.mark.parametrize(("load", "margin", "friction"), [*cells()])
def test_every_integral_over_a_turn_is_that_of_free_bodies(load, margin, friction):
    design = {"ec": 0.1, "AB": 0.125, "BC": 0.225 + margin, "omega0": 30.0, "m_slider": 0.8}
    mu = 0.3 * float(np.sqrt(2 * margin / design["BC"])) if friction else 0.0  # more would jam
    inputs = {**design, "F_Y": LOADS[load], **({"mu": mu} if friction else {})}
    by = ["ec", "BC", *(["mu"] if friction else [])]
    with mp.workdps(DIGITS):
        design["mu"] = mu
        right = Bodies(load, design).figures()
        step = mpf(margin) / 10**9
        sides = {
            p: [Bodies(load, {**design, p: mpf(design[p]) + s * step}).figures() for s in (1, -1)] for p in by
        }
        slopes = {p: {n: (a[n] - b[n]) / (2 * step) for n in a} for p, (a, b) in sides.items()}
        for name in ("T_in", "N_C"):
            slopes = {
                p: {**own, f"rms {name}": own[f"square {name}"] / (2 * mp.sqrt(right[f"square {name}"]))}
                for p, own in slopes.items()
            }
            right[f"rms {name}"] = mp.sqrt(right[f"square {name}"])
        right = {n: float(v) for n, v in right.items()}
        slopes = {p: {n: float(v) for n, v in own.items()} for p, own in slopes.items()}
    measures = [(kind, name) for name in ("T_in", "N_C") for kind in ("mean", "rms")]
    result = measured(measures, inputs)
    room = 1e-11 if margin > 1e-5 else 1e-10
    for kind, name in measures:
        size = right[f"rms {name}"]
        assert result[kind, name].value == pytest.approx(right[f"{kind} {name}"], abs=room * size)
        for p in by:
            slope = slopes[p][f"{kind} {name}"]
            scale = max(abs(slopes[p][f"rms {name}"]), abs(slope), size / design[p])
            assert result[kind, name].gradient[p] == pytest.approx(slope, abs=100 * room * scale), (
                kind,
                name,
                p,
            )
    series, motor = dx.harmonics("T_in", orders=1, **inputs), dx.drive(**inputs)
    size = right["rms T_in"]
    assert [series["mean"], series["cos"][1], series["sin"][1]] == pytest.approx(
        [right["mean T_in"], right["cos"], right["sin"]], abs=room * size
    )
    assert motor["torque_mean"] == pytest.approx(right["mean T_in"], abs=room * size)
    assert motor["torque_rms"] == pytest.approx(size, rel=room)
    assert motor["work_in"] == pytest.approx(right["work"], abs=room * 2 * np.pi * size)
    for figure, name in (("torque_mean", "mean T_in"), ("torque_rms", "rms T_in"), ("work_in", "work")):
        for p in by:
            slope = slopes[p][name]
            scale = max(abs(slopes[p]["rms T_in"]), abs(slope), size / design[p])
            assert motor["gradient"][figure][p] == pytest.approx(slope, abs=100 * room * scale), (figure, p)


def test_jumps_of_conditions_move_with_every_input():
    """A user-defined quantity that jumps where the torque passes 30 N m, by the same free bodies."""
    design = {"ec": 0.1, "AB": 0.125, "BC": 0.305, "omega0": 30.0, "m_slider": 0.8, "mu": 0.0}

    def mean(**inputs):
        bodies = Bodies("number", {**design, **inputs})

        def torque(t):
            return bodies.forces(t, t, 0)["T_in"]

        edges = bodies.edges()
        edges = sorted({*edges, *bodies.roots([lambda t: torque(t) - 3], edges)})
        total = mpf(0)
        for a, b in pairwise(edges):
            sign = 1 if torque((a + b) / 2) > 3 else -1
            total += sum((b - a) / 2 * w * sign * torque((a + b) / 2 + (b - a) / 2 * x) for x, w in RULE)
        return total / (2 * mp.pi)

    name = dx.define("rig", "where(T_in > t0, T_in, -T_in)", t0="3 N m")
    try:
        result = measured([("mean", name)], {**design, "F_Y": LOADS["number"]})["mean", name]
        series = dx.harmonics(name, orders=1, **design, F_Y=LOADS["number"])
    finally:
        dx.undefine(name)
    with mp.workdps(DIGITS):
        assert result.value == pytest.approx(float(mean()), rel=1e-12)
        assert series["mean"] == pytest.approx(float(mean()), rel=1e-12)
        for p in ("ec", "BC", "omega0", "m_slider"):
            step = mpf(10) ** -12
            sides = [mean(**{p: mpf(design[p]) + s * step}) for s in (1, -1)]
            slope = float((sides[0] - sides[1]) / (2 * step))
            assert result.gradient[p] == pytest.approx(slope, rel=1e-9), p
