"""Calls that are remembered give what the general way gives, and leave to it what is out of the ordinary."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation import arrays, call_cache
from desaxe.support.recent import Recent

SIZES = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
NAMES = ["V_C", "a_C", "status"]


@pytest.fixture
def both(monkeypatch):
    """The results of a call by its plan and by the general path, and a flag: there was a plan.

    Plans are made anew: one that refused a test's points takes no other test's either.
    """
    monkeypatch.setattr(call_cache, "_CALLS", Recent(8))

    def run(names, **inputs):
        taken = []

        def watched(*call):
            found = call_cache.planned(*call)
            taken.append(found is not None)
            return found

        monkeypatch.setattr(arrays, "planned", lambda *call: None)
        general = dx.evaluate(names, **inputs)
        monkeypatch.setattr(arrays, "planned", watched)
        return dx.evaluate(names, **inputs), general, taken == [True]

    return run


def same(found, wanted):
    return all(
        found[name].tobytes() == wanted[name].tobytes() and found[name].shape == wanted[name].shape
        for name in wanted
    )


THETA = np.linspace(-7.0, 7.0, 900).reshape(30, 30)
EC = np.linspace(-0.3, 0.3, 900).reshape(30, 30)


@pytest.mark.parametrize(
    "inputs",
    [
        {"theta": THETA, "ec": 0.01},
        {"theta": THETA, "ec": 0.0},
        {"theta": THETA, "ec": 0.22},
        {"theta": THETA, "ec": EC},
        {"theta": THETA.T, "ec": EC[::-1]},
        {"theta": np.repeat(THETA, 2, axis=1)[:, ::2], "ec": "10 mm"},
    ],
)
def test_ordinary_calls_have_a_plan(both, inputs):
    found, general, was_planned = both(NAMES, **inputs, **SIZES)
    assert was_planned
    assert same(found, general)


@pytest.mark.parametrize(
    "theta",
    [THETA.T, THETA[::2], THETA + 1e9, np.where(THETA > 0.0, np.nan, THETA), THETA.astype(np.float32)],
)
def test_others_go_the_general_way_or_give_the_same(both, theta):
    found, general, _ = both(NAMES, theta=theta, ec=0.01, **SIZES)
    assert same(found, general)


def test_what_hangs_on_rounding_is_left_to_the_general_way(both):
    last = np.arcsin((0.35 - 0.25) / 0.125)
    theta = last + 2.0**-52 * np.arange(-400.0, 400.0)
    found, general, was_planned = both(NAMES, theta=theta, ec=0.25, **SIZES)
    assert not was_planned
    assert same(found, general)


def test_a_read_only_column_and_bad_numbers(both):
    theta = THETA.reshape(-1).copy()
    theta.flags.writeable = False
    found, general, was_planned = both(NAMES, theta=theta, ec=0.01, **SIZES)
    assert was_planned
    assert same(found, general)
    with pytest.raises(ValueError, match="ec = nan"):
        dx.evaluate(NAMES, theta=theta, ec=np.nan, **SIZES)
    with pytest.raises(ValueError, match="theta: every value is bad"):
        dx.evaluate(NAMES, theta=np.full(900, np.nan), ec=0.01, **SIZES)


def test_memory_of_the_caller_is_filled_or_left_to_the_general_way(both, monkeypatch):
    theta = np.linspace(0.0, 6.0, 5000)
    fresh, _, by_plan = both(["V_C", "a_C"], theta=theta, ec=0.01, **SIZES)
    assert by_plan

    def filled(out, **inputs):
        found = dx.evaluate(["V_C", "a_C"], **{"theta": theta, **inputs}, ec=0.01, **SIZES, out=out)
        assert all(found[name] is out[name] for name in out)
        return all(np.array_equal(found[name], fresh[name]) for name in out)

    taken = []

    def watched(*call):
        taken.append(call_cache.planned(*call))
        return taken[-1]

    monkeypatch.setattr(arrays, "planned", watched)
    assert filled({name: np.empty(5000) for name in ("a_C", "V_C")})
    assert taken.pop() is not None
    strided = {name: np.empty((5000, 2))[:, 0] for name in ("V_C", "a_C")}
    assert filled(strided)
    shared = np.concatenate([theta, np.empty(5000)])  # an output begins inside of the input
    assert filled({"V_C": shared[2500:7500], "a_C": np.empty(5000)}, theta=shared[:5000])
    assert taken == [None, None]
    with pytest.raises(ValueError, match="out"):
        dx.evaluate(["V_C", "a_C"], theta=theta, ec=0.01, **SIZES, out={"V_C": np.empty(3)})


@pytest.mark.parametrize("threads", [None, 1, 2, 3])
def test_many_points_are_shared_by_threads(both, threads):
    theta = np.linspace(-7.0, 7.0, 300_001)
    given = {"theta": theta, "ec": 0.1 * np.cos(theta), **SIZES, "threads": threads}
    found, general, was_planned = both(NAMES, **given)
    assert was_planned
    assert same(found, general)


def test_many_points_of_which_some_are_left_over(both):
    """They go the general way, and so do the calls that follow."""
    theta = np.linspace(-7.0, 7.0, 50_000)
    given = {"ec": np.full_like(theta, 0.02), "AB": 0.126, "BC": 0.35, "omega0": 157.08}
    assert both(NAMES, theta=theta, **given)[2]
    far = np.where(theta > 6.9, 1e9, theta)
    for angles in (far, theta):
        found, general, was_planned = both(NAMES, theta=angles, **given)
        assert not was_planned
        assert same(found, general)


@pytest.mark.parametrize("first", [float, np.float64, lambda ec: f"{ec} m"])
def test_a_number_of_another_type_has_no_plan_of_another_design(both, first):
    """The form of a kernel goes by the design, whatever type its numbers have."""
    theta = np.linspace(1.5, 1.64, 1001)
    machine = {"AB": 0.3, "BC": np.float64(0.8), "omega0": 3.0}
    for ec in (0.01, 0.4999999999):
        found, general, was_planned = both(["a_C"], theta=theta, ec=first(ec), **machine)
        assert was_planned
        assert same(found, general)
    exact = dx.evaluate("a_C", accuracy="extended", theta=theta, ec=ec, **machine)
    np.testing.assert_allclose(found["a_C"], exact, rtol=1e-12)
