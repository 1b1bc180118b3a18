"""`solve`: values of one input at which a quantity of the design has a value; the truth is at 40 digits."""

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx


def stroke(ec, AB, BC):
    return mp.sqrt((AB + BC) ** 2 - ec**2) - mp.sqrt((BC - AB) ** 2 - ec**2)


def time_ratio(ec, AB, BC):
    swing = mp.acos(ec / (AB + BC)) - mp.acos(ec / (BC - AB))
    return (mp.pi + abs(swing)) / (mp.pi - abs(swing))


# Input, its range, the quantity, its value, the other lengths.
CASES = [
    ("AB", (0.01, 0.06), "stroke", stroke, 0.05, {"ec": 0.005, "BC": 0.15}),
    ("ec", (-0.1, 0.1), "stroke", stroke, 0.102, {"AB": 0.05, "BC": 0.2}),
    ("ec", (-0.1, 0.1), "time_ratio", time_ratio, 1.05, {"AB": 0.05, "BC": 0.2}),
    ("BC", (0.05, 0.4), "time_ratio", time_ratio, 1.1, {"AB": 0.05, "ec": 0.03}),
]


@pytest.mark.parametrize(("name", "ends", "quantity", "exact", "value", "others"), CASES)
def test_all_solutions_and_their_derivatives(name, ends, quantity, exact, value, others):
    result = dx.solve(over={name: ends}, **{quantity: value}, **others)
    with mp.workdps(40):

        def excess(x, target=value, **changed):
            return exact(**{**{k: mpf(v) for k, v in others.items()}, **changed, name: x}) - mpf(target)

        grid = [x for x in np.linspace(*ends, 4001) if turns(**{**others, name: x})]
        signs = [mp.sign(excess(mpf(float(x)))) for x in grid]
        roots = [
            mp.findroot(excess, (mpf(float(a)), mpf(float(b))), solver="anderson")
            for a, b, one, two in zip(grid, grid[1:], signs, signs[1:], strict=False)
            if one != two
        ]
        assert result[name].tolist() == pytest.approx([float(root) for root in roots], rel=1e-13)
        assert result["status"] == 0
        h = mpf(10) ** -12

        def moved(root, target=value, **changed):
            """The solution near a root for another value or another design."""
            near = root * (1 - mpf(10) ** -6), root * (1 + mpf(10) ** -6)
            return mp.findroot(lambda x: excess(x, target, **changed), near, solver="anderson")

        for k, root in enumerate(roots):
            for p, other in others.items():
                slope = (moved(root, **{p: mpf(other) + h}) - moved(root, **{p: mpf(other) - h})) / (2 * h)
                assert result["gradient"][p][k] == pytest.approx(float(slope), rel=1e-9, abs=1e-9), p
            slope = (moved(root, mpf(value) + h) - moved(root, mpf(value) - h)) / (2 * h)
            assert result["gradient"][quantity][k] == pytest.approx(float(slope), rel=1e-9)


def turns(ec, AB, BC):
    return BC - AB - abs(ec) > 0.0


def test_a_peak_in_the_units_of_a_machine():
    press = dx.Machine(units="mm, deg, rpm", ec=10, AB=50, BC=200, omega0=300, m_slider=1)
    result = press.solve(over={"m_slider": (0.1, 100)}, where={("absmax", "T_in"): "20 N m"})
    (mass,) = result["m_slider"].tolist()
    assert press.replace(m_slider=mass).peak("T_in")["value"] == pytest.approx(20.0, rel=1e-13)
    assert result["gradient"]["absmax", "T_in"] == pytest.approx([mass / 20.0], rel=1e-12)
    (crank,) = press.solve(over={"AB": (10, 100)}, stroke=120)["AB"].tolist()
    assert press.replace(AB=crank).events()["stroke"] == pytest.approx(120.0, rel=1e-13)


@pytest.mark.parametrize(
    ("measure", "value", "back"),
    [
        ("stroke", 120, lambda machine: machine.events()["stroke"]),
        ("max_pressure_angle", 17, lambda machine: machine.events()["max_pressure_angle"]),
        ("margin", 90, lambda machine: 200 - 10 - machine["AB"] * 1e3),
        ("V_outward", 1600, lambda machine: machine.events()["V_outward"]),
        (("absmax", "a_C"), 60_000, lambda machine: machine.peak("a_C")["value"]),
        (("at", "60 deg", "Y"), 220, lambda machine: machine.evaluate("Y", theta=60)),
    ],
)
def test_a_plain_value_is_in_the_units_of_the_machine(measure, value, back):
    press = dx.Machine(units="mm, deg, rpm", ec=10, AB=50, BC=200, omega0=300)
    requests = [{"where": {measure: value}}, *([{measure: value}] if isinstance(measure, str) else [])]
    for request in requests:
        (crank,) = press.solve(over={"AB": (10, 100)}, **request)["AB"].tolist()
        assert back(press.replace(AB=crank)) == pytest.approx(value, rel=1e-12)


def test_why_there_is_none():
    beyond = dx.solve(over={"AB": (0.01, 0.2)}, stroke="500 mm", ec=0.005, BC=0.15)
    assert (beyond["status"], beyond["AB"].size) == (1, 0)
    longest = float(stroke(mpf(0.005), mpf(0.145), mpf(0.15)))
    assert beyond["reachable"] == pytest.approx((float(stroke(0.005, 0.01, 0.15)), longest), rel=1e-5)
    assert "not reached: stroke = 0.5 m, reachable is" in beyond["message"]
    assert dx.solve(over={"AB": (0.3, 0.4)}, stroke=0.1, ec=0.0, BC=0.2)["status"] == 2
    assert dx.solve(over={"BC": (0.1, 0.3)}, stroke=0.1, ec=0.0, AB=0.05)["status"] == 3
    assert dx.solve(over={"AB": (0.05, 0.1)}, stroke=0.1, ec=0.0, BC=0.3)["AB"].tolist() == [0.05]


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"over": {"AB": (0.1, 0.2), "ec": (0, 0.1)}, "stroke": 0.1, "BC": 3}, "it takes one input"),
        ({"over": {"AB": (0.1, 0.2)}, "ec": 0, "BC": 3}, "the value of one quantity, .*got none"),
        ({"over": {"AB": (0.1, 0.2)}, "ec": 0, "BC": 3, "stroke": 1, "margin": 1}, "got stroke, margin"),
        ({"over": {"AB": (0.1, 0.2)}, "ec": 0, "stroke": 1}, "solve: BC is missing"),
        ({"over": {"AB": (0.2, 0.1)}, "ec": 0, "BC": 1, "stroke": 1}, "the lower bound first"),
        ({"over": {"AB": (0.1, 0.2)}, "ec": 0, "BC": 1, "stroke": "1 kg"}, "stroke"),
        ({"over": {"AB": (0.1, 0.2)}, "ec": 0, "BC": 1, "where": {"a_C": 1}}, "did you mean"),
    ],
)
def test_what_is_refused(inputs, message):
    with pytest.raises((TypeError, ValueError), match=message):
        dx.solve(**inputs)
