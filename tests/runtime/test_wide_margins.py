"""Plain forms for designs with wide margins: as exact as promised up to the edge of that test, and beyond."""

import math
import random
from functools import partial

import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.families import points
from desaxe.runtime.request import request
from desaxe.runtime.specialise import plain_form, specialise
from tests.effort import cases
from tests.evaluation.test_stress import NAMES, compiled, is_kept

SHARE = 0.875
SIDES = [f"transmission_angle_wrt_{p}" for p in ("theta", "ec", "AB", "BC")]


def edges(count):
    """Designs on both sides of the edges, where |ec| is near AB too, at angles of all kinds."""
    rng = random.Random(7)
    for _ in range(count):
        BC, share = 10 ** rng.uniform(-3, 3), rng.uniform(0.05, 0.95)
        reach = SHARE * BC * (1 + rng.choice((-1, 1)) * 2.0 ** -rng.randrange(3, 53))
        if rng.random() < 0.3:  # |ec| so near AB that u may cancel
            share = 0.5 + rng.choice((-1, 0, 1)) * 10 ** rng.uniform(-17, -2)
        AB = reach * share
        quarter = math.pi / 2 * rng.randrange(-4, 5)
        theta = rng.choice((rng.uniform(-7, 7), quarter + rng.choice((-1, 1)) * 10 ** rng.uniform(-9, -1)))
        yield {
            "theta": theta, "ec": rng.choice((-1, 1)) * (reach - AB), "AB": AB, "BC": BC,
            "omega0": rng.choice((-1, 1)) * rng.uniform(1, 100), "alpha": 0.0, "branch": rng.choice((1, -1)),
        }  # fmt: skip


POINTS = {
    "across the edge": (edges, 60, [*NAMES, *SIDES]),
    "where the pin meets the axis": (
        partial(points, "eccentric_as_crank"),
        cases(30, 120),
        ["a_C", "alpha_BC", *SIDES],
    ),
}


@pytest.mark.thorough
@pytest.mark.parametrize("where", POINTS)
def test_the_promise_holds(where):
    draw, count, names = POINTS[where]
    rows = list(draw(count))
    for row, by_kernel in zip(rows, compiled(names, rows), strict=True):
        plain = dx.evaluate(names, **row)
        for values in (plain, by_kernel):
            assert not {name: values[name] for name in names if not is_kept(name, values[name], row)}, row


def test_an_element_has_the_same_value_among_any_others():
    rng = np.random.default_rng(3)
    count = 1_500
    columns = {"theta": rng.uniform(-7, 7, count), "ec": rng.uniform(-0.2, 0.2, count)}
    machine = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
    names = ["a_C", "a_C_wrt_ec", "status"]
    whole = dx.evaluate(names, **columns, **machine)
    wide_margins = 0.125 + np.abs(columns["ec"]) < SHARE * 0.35
    assert 0.3 < wide_margins.mean() < 0.9
    # Blocks of 512 of which none, some, most and all points are close, each after one of another kind.
    some, close = np.flatnonzero(wide_margins), np.resize(np.flatnonzero(~wide_margins), 1_600)
    orders = np.concatenate([close, some[:100], close[:1_200], some, close[:700], some, close])
    parts = (wide_margins, ~wide_margins, slice(0, 1), slice(700, 1_100), slice(None, None, -1), orders)
    for chosen in parts:
        part = dx.evaluate(names, **{n: column[chosen] for n, column in columns.items()}, **machine)
        for name in names:
            assert np.array_equal(part[name], whole[name][chosen], equal_nan=True)


@pytest.mark.parametrize(
    ("name", "value"),
    [("theta", 3e6), ("ec", 1e-200), ("ec", 1e150), ("AB", 1e-180), ("AB", 0.0), ("BC", 1e200)],
)
def test_a_point_that_a_kernel_cannot_compute_is_told(name, value):
    """Too large an angle, or a length near the ends of the double range, at one point of many."""
    rng, names = np.random.default_rng(4), ["V_C", "a_C", "status"]
    columns = {"theta": rng.uniform(-7, 7, 1_100), "ec": rng.uniform(-0.05, 0.05, 1_100)}
    columns |= {"AB": rng.uniform(0.1, 0.15, 1_100), "BC": rng.uniform(0.17, 0.4, 1_100)}
    columns[name][700] = value
    result = dx.evaluate(names, **columns, omega0=3.0)
    if value > 1e60:
        assert result["status"][700] == 4
        assert np.isnan(result["a_C"][700])
        return
    alone = dx.evaluate(names, **{n: float(column[700]) for n, column in columns.items()}, omega0=3.0)
    for each in names:
        assert result[each][700] == pytest.approx(alone[each], rel=1e-12, abs=0.0, nan_ok=True)


def test_the_plain_form_is_shorter():
    given = dict.fromkeys(("theta", "ec", "AB", "BC", "omega0"), 1.0)
    asked = request(["V_C", "a_C"], given, 1, "standard")
    plain = plain_form(asked.names, asked.form, asked.fixed)
    stable = specialise(asked.names, asked.form, asked.fixed)
    assert plain is not None
    assert len(plain.lines) < 40 < len(stable.lines)
