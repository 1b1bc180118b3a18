"""A limit angle lies between two doubles: the status of both is exact."""

import numpy as np
import pytest
from flint import arb, ctx

import desaxe as dx
from tests.effort import cases

STEPS = range(-3, 4)  # doubles from the one that is nearest to the limit
SPEED = {"omega0": 1.0}


def neighbours(angle):
    """Some doubles on both sides of an angle, itself among them."""
    for step in STEPS:
        value = angle
        for _ in range(abs(step)):
            value = np.nextafter(value, np.inf * np.sign(step))
        yield float(value)


def limits(count, seed):
    """Points (theta, ec, AB, BC) next to the limit angles of mechanisms, both sides, several turns."""
    rng = np.random.default_rng(seed)
    points = []
    while len(points) < count:
        AB = 10 ** rng.uniform(-2, 1)
        BC = AB * rng.uniform(0.2, 3)
        ec = BC * rng.uniform(-1.3, 1.3)
        for side in (1, -1):
            sine = (side * arb(BC) - arb(ec)) / arb(AB)
            if abs(sine) < 1:
                first = sine.asin()
                turns = arb.pi() * (2 * int(rng.integers(-40, 40)))
                for angle in (first, arb.pi() - first, first + turns):
                    points += [(theta, ec, AB, BC) for theta in neighbours(float(angle))]
    return points


@pytest.fixture(scope="module", autouse=True)
def digits():
    before, ctx.prec = ctx.prec, 300
    yield
    ctx.prec = before


def reaches(theta, ec, AB, BC):
    """True if |ec + AB sin(theta)| < BC, proved in ball arithmetic."""
    pin = abs(arb(ec) + arb(AB) * arb(theta).sin())
    inside = pin < arb(BC)
    assert inside or pin > arb(BC)
    return bool(inside)


@pytest.mark.sampled
def test_single_points():
    for theta, ec, AB, BC in limits(cases(100, 400), 1):
        at = {"theta": theta, "ec": ec, "AB": AB, "BC": BC, **SPEED}
        inside = reaches(theta, ec, AB, BC)
        assert dx.evaluate("status", **at) == (0 if inside else 1)
        assert np.isfinite(dx.evaluate("a_C", **at)) == inside


@pytest.mark.sampled
@pytest.mark.parametrize("names", [["status", "a_C"], ["a_C", "status", "V_C_wrt_ec"]])
@pytest.mark.parametrize("threads", [1, 2])
def test_arrays(names, threads):
    points = limits(cases(400, 2_000), 2)
    theta, ec, AB, BC = np.array(points).T
    many = 20_000 * threads // len(points) + 1  # enough for every thread
    theta, ec, AB, BC = (np.tile(column, many) for column in (theta, ec, AB, BC))
    answer = dx.evaluate(names, theta=theta, ec=ec, AB=AB, BC=BC, threads=threads, **SPEED)
    inside = np.tile([reaches(*point) for point in points], many)
    assert 0.3 < inside.mean() < 0.7
    np.testing.assert_array_equal(answer["status"], np.where(inside, 0, 1))
    for name in set(names) - {"status"}:
        np.testing.assert_array_equal(np.isfinite(answer[name]), inside)


@pytest.mark.sampled
@pytest.mark.parametrize("order", [("theta", "ec"), ("ec", "theta")])
def test_grids(order):
    for point in limits(cases(35, 70), 3)[:: len(STEPS)]:
        _, ec, AB, BC = point
        theta = [*neighbours(point[0]), 0.5]
        axes = {"theta": theta, "ec": [ec, 0.25 * ec]}
        grid = dx.grid(["status", "a_C"], **{name: axes[name] for name in order}, AB=AB, BC=BC, **SPEED)
        inside = np.array([[reaches(t, e, AB, BC) for e in axes["ec"]] for t in theta])
        status = grid["status"].transpose("theta", "ec").values
        np.testing.assert_array_equal(status, np.where(inside, 0, 1))


def test_forces_and_a_given_state():
    points = limits(300, 4)
    theta, ec, AB, BC = np.array(points).T
    inside = np.array([reaches(*point) for point in points])
    loads = {"m_rod": 0.5, "m_slider": 1.0, "mu": 0.05}
    result = dx.evaluate(["status", "T_in"], theta=theta, ec=ec, AB=AB, BC=BC, omega=2.0, **loads)
    np.testing.assert_array_equal(result["status"] == 1, ~inside)
    assert np.isnan(result["T_in"][~inside]).all()


def test_what_is_decided_in_the_kernel_is_left_alone(monkeypatch):
    """Next to a change point BC - |u| is tiny, but known: nothing is answered twice."""
    from desaxe.runtime import executor

    monkeypatch.setattr(executor, "settle", None)
    theta = np.pi / 2 + np.geomspace(1e-9, 0.1, 300)
    assert np.isfinite(dx.evaluate("a_C", theta=theta, ec=0.25, AB=0.125, BC=0.375, **SPEED)).all()
