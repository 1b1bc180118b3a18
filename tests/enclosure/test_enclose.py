"""`enclose`: every point of a box is inside, the ends are as near as was asked, and nothing else is claimed.

The truth is that of tests/force_truth.py, at doubles inside the box.
"""

import itertools
import math
import random
import sys

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

import desaxe as dx
from desaxe.compiler.operations import OPERATIONS
from desaxe.compiler.passes.differentiate import CONSTANT, LINEAR, RULES, with_derivatives
from desaxe.enclosure import balls as _balls
from desaxe.mechanism.program import LAW as LAW_FORM
from desaxe.oracle.force_truth import force_names, truth
from desaxe.oracle.truth import LAW, STATE, all_names
from desaxe.runtime.specialise import specialise
from desaxe.support.extras import MissingExtraError
from tests.effort import cases
from tests.evaluation.test_force_values import bodies, points
from tests.points import draw

between = dx.between
TURN = dx.between(0.0, 2 * math.pi)
SIZES = {"ec": 0.05, "AB": 0.125, "BC": 0.35, "omega0": 157.0}
LOADED = SIZES | {"m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.01, "g_Y": -9.81}
TOLERANCES = {
    "ec": between(0.0499, 0.0501),
    "AB": between(0.1249, 0.1251),
    "BC": between(0.3499, 0.3501),
    "omega0": between(156.0, 158.0),
}


def holds(result, exact):
    """True if the range holds a value known to 50 digits, or if the value is NaN."""
    with mpmath.workdps(60):
        slack = abs(exact) * mpmath.mpf(10) ** -45
        inside = mpmath.mpf(result["lower"]) - slack <= exact <= mpmath.mpf(result["upper"]) + slack
    return bool(mpmath.isnan(exact)) or bool(inside)


def excess(result):
    """Excess width of the range over the attained one, relative to the latter."""
    low, high = result["inner"]
    return ((low - result["lower"]) + (result["upper"] - high)) / (high - low)


def inside(rng, box):
    """A point of a box, at an end of some inputs."""
    return {
        name: rng.choice([*value, rng.uniform(*value), rng.uniform(*value)])
        if isinstance(value, tuple)
        else value
        for name, value in box.items()
    }


def widened(rng, point, names, width):
    """A box around a point: some of its inputs with tolerances of this relative width."""
    box = dict(point)
    for name in names:
        middle, half = point[name], 0.5 * width * abs(point[name])
        box[name] = between(middle - half * rng.random(), middle + half * rng.random())
    return box


# ---- one point ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "kind", ["generic", "branch -1", "long crank", "slowing down", "state", "concentric"]
)
@pytest.mark.sampled
def test_a_point_is_enclosed_to_a_last_bit(kind):
    names = all_names(STATE if kind == "state" else LAW)
    for number, point in enumerate(draw(kind, cases(2, 5))):
        for name in names[number::10]:
            result, exact = dx.enclose(name, **point), truth(name, **point)
            assert holds(result, exact), (name, point)
            assert result["upper"] <= math.nextafter(result["lower"], math.inf), (name, point)
            assert result["status"] == 0
            assert result["tight"]


@pytest.mark.sampled
@pytest.mark.parametrize("kind", ["friction", "default_centres"])
def test_forces_at_a_point(kind):
    names = force_names()
    for number, point in enumerate(points("slowing down", kind, cases(2, 6))):
        for name in names[number::18]:
            result = dx.enclose(name, **point)
            assert holds(result, truth(name, **point)), (name, point)
            assert result["upper"] <= math.nextafter(result["lower"], math.inf), (name, point)


def test_next_to_the_change_point_a_point_keeps_its_last_bit():
    for power, distance in itertools.product((20, 35, 50), (0.0, 1e-3, -1e-9)):
        at = {"ec": 0.225, "AB": 0.125, "BC": 0.35 * (1 + 2.0**-power), "omega0": 157.0}
        for name in ("a_C", "a_C_wrt_ec", "j_C", "alpha_BC_wrt_theta"):
            point = at | {"theta": math.pi / 2 + distance}
            result = dx.enclose(name, **point)
            assert holds(result, truth(name, **point))
            assert result["upper"] <= math.nextafter(result["lower"], math.inf)


# ---- boxes ----------------------------------------------------------------------------------------

KINDS = (
    "generic",
    "branch -1",
    "long crank",
    "concentric",
    "speeding up",
    "slowing down",
    "from rest",
    "state",
)


@pytest.mark.sampled
@settings(max_examples=cases(15, 60), deadline=None, derandomize=True)
@given(st.sampled_from(KINDS), st.integers(0, 10**9), st.floats(-15.0, -0.3), st.booleans())
def test_every_point_of_a_box_is_inside(kind, seed, exponent, forces):
    rng = random.Random(seed)
    point = rng.choice(list(draw(kind, 30)))
    if forces:
        point |= bodies(rng, rng.choice(["smooth", "friction", "default_centres"]), point["AB"], point["BC"])
    state = "omega" in point
    choices = force_names() if forces and not state else all_names(STATE if state else LAW)
    name = rng.choice(choices)
    varying = [p for p in point if p != "branch" and rng.random() < 0.5]
    box = widened(rng, point, varying, 10.0**exponent)
    result = dx.enclose(name, **box, rtol=1e-3, boxes=60)
    assert result["lower"] <= result["inner"][0] <= result["inner"][1] <= result["upper"]
    for _ in range(6):
        at = inside(rng, box)
        defined = not math.isnan(dx.evaluate(name, **at))
        assert result["status"] in ((0, 2) if defined else (1, 2))
        assert not defined or holds(result, truth(name, **at)), (name, box, at)


@pytest.mark.sampled
@pytest.mark.parametrize("name", ["Y", "a_C", "j_C", "a_C_wrt_ec", "a_C_wrt_ec_AB", "phi_wrt_theta"])
def test_boxes_one_ulp_wide(name):
    for point in draw("generic", cases(2, 6)):
        box = {p: between(x, math.nextafter(x, math.inf)) if p in LAW[:5] else x for p, x in point.items()}
        result = dx.enclose(name, **box)
        assert result["tight"]
        assert result["status"] == 0
        corners = [dict(zip(LAW[:5], c, strict=True)) for c in itertools.product(*(box[p] for p in LAW[:5]))]
        exact = [truth(name, digits=30, **point | corner) for corner in corners]
        assert holds(result, min(exact))
        assert holds(result, max(exact))
        # Over one ulp nothing bends: the extremes are at corners.
        spread, last_bit = max(exact) - min(exact), math.ulp(result["upper"])
        assert result["upper"] - result["lower"] <= spread + 4 * last_bit


@pytest.mark.parametrize(
    "box",
    [
        {"theta": between(math.pi / 2 - 0.1, math.pi / 2 + 0.1)},
        {"theta": between(-math.pi / 2 - 1e-9, -math.pi / 2 + 1e-8), "ec": between(0.049, 0.051)},
        {"theta": between(-0.02, 0.01), "ec": between(-0.01, 0.02)},
        {
            "theta": between(math.pi - 0.1, math.pi + 0.2),
            "ec": between(-1e-3, 1e-3),
            "AB": between(0.12, 0.13),
        },
        {"theta": between(0.5, 0.55), "BC": between(0.34, 0.36)},
        {"theta": between(100.0, 100.3), "ec": between(0.0, 0.01)},
        {"theta": between(1e6, 1e6 + 0.1)},
    ],
)
@pytest.mark.sampled
@pytest.mark.parametrize("name", ["phi", "Y", "s", "a_C", "a_C_wrt_ec", "pressure_angle"])
def test_where_the_program_changes_its_form(name, box):
    """sin(theta) = 0, |sin(theta)| = 1/2 and 1, ec = 0, u = 0: tight all the same."""
    box, rng = SIZES | box, random.Random(str(box))
    result = dx.enclose(name, **box)
    assert result["tight"]
    assert result["status"] == 0
    assert excess(result) <= 2.1e-6
    exact = [truth(name, digits=20, **inside(rng, box)) for _ in range(cases(15, 60))]
    assert all(holds(result, value) for value in exact)
    assert result["boxes"] < 2000


# ---- known ranges ---------------------------------------------------------------------------------


def test_a_monotone_range_is_that_of_its_ends():
    box = SIZES | {"theta": 1.0, "AB": between(0.12, 0.13), "omega0": between(150.0, 160.0)}
    result = dx.enclose("V_B", **box)
    assert result["lower"] == pytest.approx(0.12 * 150.0, rel=1e-15)
    assert result["upper"] == pytest.approx(0.13 * 160.0, rel=1e-15)
    assert result["lower"] <= 0.12 * 150.0
    assert result["upper"] >= 0.13 * 160.0
    tolerance = dx.enclose("a_C", theta=between(1.0, 1.001), **TOLERANCES)
    values = [
        dx.evaluate("a_C", theta=t, ec=e, AB=a, BC=b, omega0=w)
        for t, e, a, b, w in itertools.product((1.0, 1.001), *TOLERANCES.values())
    ]
    assert tolerance["lower"] == pytest.approx(min(values), rel=1e-14)
    assert tolerance["upper"] == pytest.approx(max(values), rel=1e-14)
    assert tolerance["boxes"] < 10


def test_a_range_with_a_sign_change_inside():
    """|ec| has its smallest value 0 inside, which is the largest margin."""
    result = dx.enclose("margin", ec=between(-0.02, 0.01), AB=0.125, BC=between(0.34, 0.35))
    assert result["lower"] == pytest.approx(0.34 - 0.125 - 0.02)
    assert result["upper"] == pytest.approx(0.35 - 0.125, rel=1e-6)
    assert result["upper"] >= 0.225


@pytest.mark.parametrize("name", ["V_C", "a_C", "j_C", "omega_BC", "a_C_wrt_ec"])
def test_a_turn_against_the_peak(name):
    result, peak = dx.enclose(name, theta=TURN, **SIZES), dx.peak(name, **SIZES)["value"]
    largest = max(abs(result["lower"]), abs(result["upper"]))
    assert peak <= largest * (1 + 1e-15)
    assert largest <= peak * (1 + 3e-6)


def test_a_turn_with_tolerances_against_the_peaks_of_its_corners():
    result = dx.enclose("a_C", theta=TURN, **TOLERANCES)
    corners = np.array(list(itertools.product(*TOLERANCES.values())))
    peaks = dx.peak("a_C", **dict(zip(TOLERANCES, corners.T, strict=True)))["value"]
    assert result["tight"]
    assert -result["lower"] == pytest.approx(peaks.max(), rel=3e-6)
    assert -result["lower"] >= peaks.max() * (1 - 1e-14)


@pytest.mark.thorough
def test_friction_and_a_torque_over_a_turn_against_many_points():
    box = LOADED | {"theta": TURN, "m_rod": between(1.0, 1.1), "mu": between(0.1, 0.11)}
    theta, rod, mu = np.meshgrid(np.linspace(*TURN, 401), [1.0, 1.1], [0.1, 0.11])
    for name in ("T_in", "N_C", "F_friction"):
        result = dx.enclose(name, **box)
        values = dx.evaluate(name, **LOADED | {"theta": theta, "m_rod": rod, "mu": mu})
        width = np.nanmax(values) - np.nanmin(values)
        assert result["status"] == 0
        assert result["tight"]
        assert result["lower"] <= np.nanmin(values) <= result["lower"] + 1e-3 * width
        assert result["upper"] - 1e-3 * width <= np.nanmax(values) <= result["upper"]


def test_a_jump_belongs_to_the_range():
    """The law turns backwards for negative omega0: V_C jumps at 0, where alpha alone moves the crank."""
    result = dx.enclose("V_C", theta=1.0, ec=0.02, AB=0.125, BC=0.35, omega0=between(-3.0, 3.0), alpha=2.0)
    at = {"theta": 1.0, "ec": 0.02, "AB": 0.125, "BC": 0.35, "alpha": 2.0}
    for speed in (-3.0, -1e-300, 0.0, 3.0):
        assert holds(result, truth("V_C", omega0=speed, **at))
    assert (
        result["upper"]
        == pytest.approx(-result["lower"])
        == pytest.approx(dx.evaluate("V_C", omega0=-3.0, **at), rel=1e-5)
    )


# ---- what is not feasible -------------------------------------------------------------------------

ROCKER = {"ec": 0.3, "AB": 0.125, "BC": 0.35, "omega0": 10.0}


def test_nowhere_feasible():
    result = dx.enclose("a_C", theta=between(1.4, 1.6), **ROCKER)
    assert result["status"] == 1
    assert all(map(math.isnan, (result["lower"], result["upper"], *result["inner"])))


def test_partly_feasible():
    """What stays finite at a limit angle has a tight range over the feasible part; what does not has none."""
    Y = dx.enclose("Y", theta=TURN, **ROCKER)
    values = dx.evaluate("Y", theta=np.linspace(*TURN, 100_001), **ROCKER)
    assert Y["status"] == 2
    assert Y["tight"]
    assert Y["lower"] <= np.nanmin(values) <= Y["lower"] + 3e-3
    assert Y["upper"] - 1e-6 <= np.nanmax(values) <= Y["upper"]
    a_C = dx.enclose("a_C", theta=TURN, **ROCKER)
    assert a_C["status"] == 2
    assert not a_C["tight"]
    assert a_C["lower"] == -math.inf
    low, high = a_C["inner"]
    assert low < -1e6
    assert math.isfinite(low)
    assert math.isfinite(high)


@pytest.mark.thorough
@pytest.mark.sampled
def test_the_change_point():
    """A box that touches it, one a little short of it, and one beyond."""
    rtol = 10.0 ** -cases(4, 6)
    design = {"theta": between(1.5, 1.6), "AB": 0.125, "BC": 0.375, "omega0": 10.0, "rtol": rtol}
    touching = dx.enclose("a_C", ec=between(0.24, 0.25), **design)
    assert touching["status"] == 2
    assert touching["upper"] == math.inf
    phi = dx.enclose("phi", ec=between(0.24, 0.25), **design)
    assert phi["status"] == 2
    assert phi["tight"]
    assert phi["upper"] == pytest.approx(math.pi / 2, abs=rtol)
    assert phi["upper"] >= math.pi / 2
    near = dx.enclose("a_C", ec=between(0.24, 0.25 - 2.0**-30), **design)
    assert near["status"] == 0
    assert near["tight"]
    assert excess(near) <= 2.1 * rtol
    assert dx.enclose("delta", ec=between(-0.26, -0.25), **design | {"theta": -1.5})["status"] == 2
    beyond = dx.enclose("a_C", ec=between(0.255, 0.26), **design | {"theta": between(1.56, 1.58)})
    assert beyond["status"] == 1


def test_a_crank_that_stalls():
    at = {"ec": 0.02, "AB": 0.125, "BC": 0.35, "theta": between(0.1, 2.0)}
    assert dx.enclose("V_C", **at, omega0=between(0.0, 1.0), alpha=between(-2.0, -1.0))["status"] == 2
    assert dx.enclose("V_C", **at, omega0=0.0, alpha=between(-2.0, -1.0))["status"] == 1
    assert dx.enclose("Y", **at)["status"] == 0
    partly = dx.enclose("V_C", **at, omega0=between(1.0, 2.0), alpha=-1.0, rtol=1e-3)
    values = dx.evaluate("V_C", **at | {"theta": np.linspace(1.0, 2.0, 101)[:, None]},
                         omega0=np.linspace(1.0, 2.0, 101), alpha=-1.0)  # fmt: skip
    assert partly["status"] == 2
    assert partly["lower"] <= np.nanmin(values)
    assert partly["upper"] >= np.nanmax(values)


def test_friction_that_may_jam():
    box = {"theta": 0.2, "ec": 0.3, "AB": 0.125, "BC": 0.35, "omega": 1.0, "F_X": 1.0}
    assert dx.enclose("N_C", **box, mu=between(0.0, 4.0))["status"] == 2
    assert dx.enclose("N_C", **box, mu=between(0.0, 0.1))["status"] == 0
    assert dx.enclose("F_shaking_X", **box)["status"] == 0


def test_many_turns_are_as_one():
    """Unless the law counts them."""
    one = dx.enclose("a_C", theta=TURN, **SIZES)
    many = dx.enclose("a_C", theta=between(-1e9, 1e12), **SIZES)
    assert many["tight"]
    assert many["boxes"] < 2 * one["boxes"]
    assert (many["lower"], many["upper"]) == pytest.approx((one["lower"], one["upper"]), rel=3e-6)
    faster = dx.enclose("a_C", theta=between(0.0, 12.0), **SIZES, alpha=100.0)
    assert faster["tight"]
    assert faster["lower"] < 1.05 * one["lower"]


def test_a_derivative_by_a_speed_that_may_vanish():
    result = dx.enclose(
        "V_C_wrt_omega0", theta=between(1.0, 1.01), ec=0.05, AB=0.125, BC=0.35, omega0=between(-3.0, 3.0)
    )
    slopes = [dx.evaluate("Y_wrt_theta", theta=t, ec=0.05, AB=0.125, BC=0.35) for t in (1.0, 1.01)]
    assert [result["upper"], result["lower"]] == pytest.approx(slopes, rel=1e-14)


# ---- how -------------------------------------------------------------------------------------------


def test_a_limit_of_boxes_is_told_and_safe():
    result = dx.enclose("a_C", theta=TURN, **TOLERANCES, boxes=20)
    better = dx.enclose("a_C", theta=TURN, **TOLERANCES)
    assert not result["tight"]
    assert result["boxes"] < 100
    assert result["lower"] < better["lower"]
    assert result["upper"] > better["upper"]


def test_a_finer_tolerance_is_kept():
    for rtol in (1e-2, 1e-4, 1e-8):
        assert excess(dx.enclose("a_C", theta=TURN, **SIZES, rtol=rtol)) <= 2.1 * rtol


def test_undecided_sides_that_count_as_the_same_are_the_same():
    """Each of these selects has the same value on both sides, to 100 digits, wherever it is."""
    program = specialise(("s", "j_C_wrt_theta"), LAW_FORM, (("branch", 1.0), ("alpha", 0.0)))
    sides = {line.name: line.args[1:] for line in program.lines if line.op == "select"}
    assert set(_balls.SAME) <= set(sides)
    for point in draw("generic", 30):
        with ctx.workprec(400):
            run = _balls._Run(program, {p: (point[p], point[p]) for p in program.inputs})
            for line in program.lines:
                run.step(line)
            for name in _balls.SAME:
                first, second = map(run.value, sides[name])
                assert abs(first - second) <= arb(2) ** -300 * (1 + abs(first)), (name, point)


@pytest.mark.parametrize("sign", ["_sigma", "_out"])
@pytest.mark.parametrize("side", [1, -1])
def test_the_signs_may_be_chosen_either_way(sign, side, monkeypatch):
    """All equations are identities in sigma and nu: with the wrong one the values are the same."""
    for point in draw("generic", 12):
        names = tuple(n for n in all_names() if n != "margin")
        program = specialise(names, LAW_FORM, (("branch", 1.0),))
        box = {p: (point[p], point[p]) for p in program.inputs}
        right = _balls.enclosures(program, box, 400).values
        monkeypatch.setattr(_balls._Run, sign, lambda run, *_: side)
        chosen = _balls.enclosures(program, box, 400).values
        monkeypatch.undo()
        for name, a, b in zip(names, right, chosen, strict=True):
            assert abs(a - b) <= arb(2) ** -250 * (1 + abs(a)), (name, point)


@pytest.mark.parametrize(
    "name", ["s", "V_C", "a_C", "alpha_BC", "phi", "delta", "V_B", "T_in", "kinetic_energy"]
)
def test_derivatives_line_by_line_are_the_derived_ones(name):
    """What serves where nothing is derived, against the sensitivities that are."""
    for point in points("slowing down", "friction", 3):
        own = specialise((name,), LAW_FORM, (("branch", 1.0),))
        parameters = tuple(p for p in own.inputs)
        derived = specialise((name, *(f"{name}_wrt_{p}" for p in parameters)), LAW_FORM, (("branch", 1.0),))
        box = {p: (point[p], point[p]) for p in parameters}
        result = _balls.enclosures(with_derivatives(own, parameters), box, 300).values
        for p, a, b in zip(
            ("", *parameters), result, _balls.enclosures(derived, box, 300).values, strict=True
        ):
            assert abs(a - b) <= arb(2) ** -200 * (1 + abs(a)), (p, point)


def test_inputs_with_units_and_of_other_kinds():
    machine = {"AB": "125 mm", "BC": "0.35 m", "omega0": "1500 rpm"}
    result = dx.enclose("a_C", theta="60 deg", ec=between("9.9 mm", "10.1 mm"), **machine)
    numbers = dx.enclose(
        "a_C", theta=math.pi / 3, ec=between(0.0099, 0.0101), AB=0.125, BC=0.35, omega0=50 * math.pi
    )
    assert result["lower"] == pytest.approx(numbers["lower"], rel=1e-14)
    assert dx.enclose("Y", theta=1, ec=between(0.0, 0.01), AB=between(0.125, 0.125), BC=0.35)["status"] == 0


@pytest.mark.parametrize(
    ("error", "words", "wrong"),
    [
        (ValueError, "lower one first", {"ec": between(0.2, 0.1)}),
        (ValueError, "number or a pair", {"ec": (0.1, 0.15, 0.2)}),
        (ValueError, "number or a pair", {"ec": np.array([0.1, 0.15])}),
        (ValueError, "length >= 0", {"AB": between(-0.1, 0.1)}),
        (ValueError, "finite", {"theta": between(0.0, math.inf)}),
        (TypeError, "BC is missing", {"BC": None}),
        (TypeError, "no input 'mass'", {"mass": 1.0}),
        (ValueError, "not both", {"omega": 1.0}),
        (ValueError, r"dx\.between\(low, high\) or dx\.plus_minus", {"ec": "10 mm +- 0.1 mm"}),
        (ValueError, "lower one first", {"ec": between("10 mm", "0.1 mm")}),
        (TypeError, r"enclose\(\) has no input 'rod'; did you mean BC[, ]", {"rod": 1.0}),
        (ValueError, "rtol", {"rtol": 0.0}),
        (ValueError, "boxes", {"boxes": 0}),
    ],
)
def test_complaints(error, words, wrong):
    with pytest.raises(error, match=words):
        dx.enclose("a_C", **{"theta": 1.0, **SIZES, **wrong})


def test_names_that_have_no_range():
    with pytest.raises(ValueError, match="status"):
        dx.enclose("status", theta=1.0, **SIZES)
    with pytest.raises(ValueError, match="did you mean"):
        dx.enclose("a_c", theta=1.0, **SIZES)


def test_without_the_extra(monkeypatch):
    monkeypatch.delitem(dx.__dict__, "enclose", raising=False)
    for module in ("desaxe.enclosure.enclose", "desaxe.enclosure.balls"):
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(MissingExtraError, match=r"desaxe\[rigorous\]"):
        dx.enclose("Y", theta=1.0, **SIZES)


def test_every_operation_has_its_rules():
    """A new operation of numbers must say what it is over balls, and what its derivative is."""
    numbers = {op for op, row in OPERATIONS.items() if row.signature[-1] == "f" or op == "copy"}
    tables = {op for op, row in OPERATIONS.items() if "t" in row.signature}  # `enclose` takes no loads
    assert numbers - set(_balls._NUMBERS) <= {"floor", *tables}  # floor: of the written-out sine alone
    assert numbers - {*RULES, *LINEAR, *CONSTANT} <= {"floor", "lookup", "lookup_slope"}
