"""The promise of accuracy="standard", held at families of points where formulas lose their digits.

A forward error of at most 8 ulp x (1 + sum of the condition numbers with respect to theta, AB, BC, omega0,
alpha and the margin), by both ways that numbers take: plain Python with the C library's sine, and a compiled
kernel with its own. Where the bound leaves no digit, nothing is promised.
"""

import itertools
import math
import sys

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import desaxe as dx
from desaxe.oracle import force_truth
from desaxe.oracle.families import FAMILIES, Rng, points, rescaled
from desaxe.oracle.truth import LAW, all_names, conditions, truth, ulp_error
from tests.effort import cases

NAMES = [
    q + tail
    for q in ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
    for tail in ("", *(f"_wrt_{p}" for p in LAW))
]
BY_KERNEL = NAMES if cases(0, 1) else [*NAMES[::7], "V_C_wrt_ec", "a_C_wrt_BC"]  # all of them take seconds
ONE_ULP_OF_NOTHING = 2.0**53
MOST = sys.float_info.max


def is_kept(name, value, at, oracle=truth, sensitivity=conditions):
    """True if the value keeps its promised bound, or if there is no mechanism at the point."""
    exact = oracle(name, **at)
    if mpmath.isnan(exact):
        return True  # beyond the last angle by less than a double, say
    if abs(exact) > MOST / 2:  # overflow; at rest, a limit may be infinite
        return not abs(value) < MOST / 2
    error = ulp_error(value, exact)
    if error <= 8:
        return True
    bound = 8 * (1 + sensitivity(name, **at))
    return error <= bound or bound >= ONE_ULP_OF_NOTHING


# A gap that is exact there may count as an input in place of the margin: the smaller sum holds.
GAPS = {"eccentric_as_rod": ("margin", "rod"), "eccentric_as_crank": ("margin", "crank")}
GAPS["long_rod"] = ("margin", "ec")
WIDE = 0.875  # of the rod: with wide margins a crank as long as the eccentricity is nothing special


def sensitivity_in(family):
    """The conditions of a family's points.

    Derivatives by alpha have the margin alone: under the law they are 2 theta Y'' + Y', which cancels
    whatever the gap is.
    """

    def least(name, **at):
        wide = family == "eccentric_as_crank" and at["AB"] + abs(at["ec"]) < WIDE * at["BC"]
        plain = wide or name.endswith("_wrt_alpha")
        gaps = ("margin",) if plain else GAPS.get(family, ("margin",))
        return min(conditions(name, gap, **at) for gap in gaps)

    return least


FAR = 1.6e6  # rad: beyond, a kernel takes the C library's sine for its whole column


def compiled(names, rows):
    """The values of rows of inputs, by a compiled kernel for each branch, near angles and far ones."""
    answers = [{} for _ in rows]
    inputs = [name for name in rows[0] if name != "branch"]
    for branch, far in itertools.product((1, -1), (False, True)):
        chosen = [
            n for n, row in enumerate(rows) if (row["branch"], abs(row["theta"]) > FAR) == (branch, far)
        ]
        columns = {name: np.array([rows[number][name] for number in chosen]) for name in inputs}
        if chosen:
            result = dx.evaluate(names, **columns, branch=branch)
            for place, number in enumerate(chosen):
                answers[number] = {name: float(result[name][place]) for name in names}
    return answers


@pytest.mark.sampled
@pytest.mark.parametrize("family", FAMILIES)
def test_the_promise_is_kept(family):
    rows = list(points(family, cases(12, 200)))
    for row, by_kernel in zip(rows, compiled([*BY_KERNEL, "status"], rows), strict=True):
        plain = dx.evaluate(NAMES, **row)
        broken = {
            name: values[name]
            for values in (plain, by_kernel)
            for name in values
            if name != "status" and not is_kept(name, values[name], row, truth, sensitivity_in(family))
        }
        assert not broken, row


@pytest.mark.sampled
@pytest.mark.parametrize("family", ["change_point", "near_change_point", "folded_over"])
def test_every_name_next_to_the_change_point(family):
    """Second derivatives too."""
    for at in points(family, cases(4, 40), seed=4):
        values = dx.evaluate(all_names(), **at)
        assert not [name for name in values if not is_kept(name, values[name], at)], at


def bodies(rng, at):
    """Masses, inertias and loads of the size that the motion has; with and without friction."""
    mass = {name: 10 ** rng.uniform(-2, 2) for name in ("m_crank", "m_rod", "m_slider")}
    thrust = mass["m_slider"] * at["omega0"] ** 2 * at["AB"]
    return mass | {
        "I_crank": mass["m_crank"] * at["AB"] ** 2 * rng.random(),
        "I_rod": mass["m_rod"] * at["BC"] ** 2 * rng.random(),
        "F_X": thrust * rng.uniform(-1, 1) * rng.choice((0, 1)),
        "F_Y": thrust * rng.uniform(-1, 1),
        "g_Y": rng.choice((0.0, -9.81)),
        "mu": rng.choice((0.0, 0.0, 0.1)),
    }


@pytest.mark.sampled
@pytest.mark.parametrize("family", [family for family in FAMILIES if family != "units"])
def test_the_torque_keeps_the_promise(family):
    rng = Rng(f"torque: {family}")
    for at in points(family, cases(10, 40), seed=1):
        loaded = at | bodies(rng, at)
        assert is_kept(
            "T_in", dx.evaluate("T_in", **loaded), loaded, force_truth.truth, force_truth.conditions
        )


TORQUE_UNITS = {  # powers of length, of rate and of mass
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), (0, 0, 1)),
    **dict.fromkeys(("I_crank", "I_rod"), (2, 0, 1)),
    **{"F_X": (1, 2, 1), "F_Y": (1, 2, 1), "g_Y": (1, 2, 0)},
}


@pytest.mark.parametrize("powers", list(itertools.product((-60, 60), (-40, 0, 40), (-40, 40))))
def test_units_leave_no_trace_in_the_torque(powers):
    """Powers of two as units of length, rate and mass change no bit of it."""
    length, rate, mass = powers
    rng = Rng("torque: units")
    for at in points("generic", 20, seed=2):
        loaded = at | bodies(rng, at)
        scaled = rescaled(loaded, length, rate)
        for name, dimensions in TORQUE_UNITS.items():
            scaled[name] = math.ldexp(loaded[name], sum(map(math.prod, zip(dimensions, powers, strict=True))))
        torque = dx.evaluate("T_in", **loaded)
        assert dx.evaluate("T_in", **scaled) == math.ldexp(torque, 2 * length + 2 * rate + mass)


@pytest.mark.parametrize("unit", [-90, 90])
@pytest.mark.parametrize(
    "family", ["generic", "change_point", "near_change_point", "folded_over", "last_angle"]
)
def test_units_leave_no_trace(family, unit):
    """Powers of two as units of length and of time change no bit of what does not overflow."""
    names = ["Y", "V_C", "a_C", "omega_BC"]
    for at in points(family, 20, seed=3):
        plain, long = dx.evaluate(names, **at), dx.evaluate(names, **rescaled(at, unit, 0))
        fast = dx.evaluate(names, **rescaled(at, 0, unit))
        assert long == {name: math.ldexp(plain[name], unit * (name != "omega_BC")) for name in names}
        assert fast == {
            name: math.ldexp(plain[name], unit * power)
            for name, power in zip(names, (0, 1, 2, 1), strict=True)
        }


@pytest.mark.parametrize("rate", [-90, 90])
def test_units_of_time_and_tiny_angles(rate):
    """theta/omega may be too small for a double where the derivative of V_C by alpha is not."""
    names = ["V_C_wrt_alpha", "omega_BC_wrt_alpha"]
    for at in points("tiny_angle", 60, seed=5):
        scaled = rescaled(at, rate, rate)
        values = dx.evaluate(names, **scaled)
        assert [name for name in names if not is_kept(name, values[name], scaled)] == [], scaled


ODD = (
    0.0, -0.0, 5e-324, -5e-324, 2.2e-308, -1e-310, 1e-170, 1e-60, 1.0, -1.0, 1e60, 1.1e60, 1.7e308,
    math.inf, -math.inf, math.nan,
)  # fmt: skip
REAL = [x for x in ODD if abs(x) <= 1e60]
USUAL = {"theta": 1.0, "ec": 0.1, "AB": 0.2, "BC": 0.5, "omega0": 3.0, "alpha": 0.5}


@pytest.mark.sampled
@pytest.mark.parametrize("name", LAW)
def test_odd_numbers_in_a_column(name):
    """No crash; NaN and status 4 where the number is bad; a number that is good is told apart."""
    column = np.array([*ODD, USUAL[name]])
    columns = {each: np.full(len(column), usual) for each, usual in USUAL.items()}  # one kernel serves all
    result = dx.evaluate([*BY_KERNEL, "status"], **columns | {name: column})
    least = {"AB": 0.0, "BC": 1e-60}.get(name, -math.inf)
    for place, number in enumerate(column):
        bad = not (math.isfinite(number) and number >= least and (name == "theta" or abs(number) <= 1e60))
        assert (result["status"][place] == 4) == bad, number
        if result["status"][place] != 0:
            assert all(math.isnan(result[n][place]) for n in ("V_C", "a_C")) or result["status"][place] == 2
    assert result["status"][-1] == 0
    assert all(math.isfinite(result[n][-1]) for n in BY_KERNEL)


@pytest.mark.sampled
@given(st.fixed_dictionaries({name: st.sampled_from(REAL) for name in LAW}))
@settings(max_examples=cases(60, 300), deadline=None)
def test_odd_numbers_do_not_crash(at):
    at = at | {"AB": abs(at["AB"]), "BC": max(abs(at["BC"]), 1e-60)}
    result = dx.evaluate([*NAMES, "status", "margin"], **at)
    assert result["status"] in (0, 1, 2, 3)
    assert result["status"] != 1 or math.isnan(result["V_C"])


@pytest.mark.sampled
@given(
    st.floats(-10, 10),
    st.floats(0.01, 1).filter(bool),
    st.floats(-1, 1),
    st.integers(-50, 50),
    st.sampled_from((1, -1)),
)
@example(-0.0, 1.0, 0.5, 0, 1)  # the sign of a zero says on which side the crank is, everywhere the same
@settings(max_examples=cases(30, 150), deadline=None)
def test_any_margin(theta, crank, share, power, branch):
    """Any angle, any mechanism that turns fully, with a margin down to a last bit."""
    ec = crank * share
    BC = (crank + abs(ec)) * (1 + 2.0 ** -abs(power) * (power > 0))
    at = {"theta": theta, "ec": ec, "AB": crank, "BC": BC, "omega0": 7.0, "alpha": 0.0, "branch": branch}
    values = dx.evaluate(NAMES, **at)
    assert [name for name in NAMES if not is_kept(name, values[name], at)] == []
