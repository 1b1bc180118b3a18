"""Synthesis: designs have the required values, none is missing, and the limits are exact."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import desaxe as dx


def has(design, stroke, ratio, rel=1e-13):
    result = dx.events(**design)
    assert result["stroke"] == pytest.approx(stroke, rel=rel)
    assert result["time_ratio"] == pytest.approx(ratio, rel=rel)
    assert result["status"] in (0, 2)
    return result


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])  # a busy machine
@given(AB=st.floats(0.05, 0.95), share=st.floats(0.01, 0.99), side=st.sampled_from([1, -1]))
def test_there_and_back(AB, share, side):
    """A design's own stroke, time ratio and third wish lead back to it."""
    ec, BC = side * share * (1.0 - AB), 1.0
    result = dx.events(ec=ec, AB=AB, BC=BC)
    wish = {"stroke": result["stroke"], "time_ratio": result["time_ratio"], "slow_stroke": side}
    assume(result["time_ratio"] > 1.0 + 1e-4)
    for third, value in (("BC", BC), ("AB", AB), ("max_pressure_angle", result["max_pressure_angle"])):
        answer = dx.synthesize(**wish, **{third: value})
        if not answer["solutions"]:  # at the least pressure angle, within rounding
            low, high = answer["limits"][third]
            assert min(abs(value / low - 1), abs(value / high - 1)) < 1e-7
            continue
        apart = [max(abs(d["ec"] - ec), abs(d["AB"] - AB), abs(d["BC"] - BC)) for d in answer["solutions"]]
        flat = third == "max_pressure_angle"  # its root is double at the least angle
        assert min(apart) < (1e-5 if flat else 1e-9)
        for design in answer["solutions"]:
            has(design, result["stroke"], result["time_ratio"], 1e-11)


@pytest.mark.parametrize("third", ["BC", "AB"])
def test_limits_of_a_length_are_where_designs_end(third):
    wish = {"stroke": 0.0888, "time_ratio": 1.67}
    low, high = dx.synthesize(**wish, **{third: 0.05 if third == "BC" else 0.03})["limits"][third]
    for end, inward in ((low, 1), (high, -1)):
        inside = dx.synthesize(**wish, **{third: end * (1 + inward * 1e-6)})
        outside = dx.synthesize(**wish, **{third: end * (1 - inward * 1e-6)})
        assert len(inside["solutions"]) == 1
        assert (outside["solutions"], outside["status"]) == ([], 1)
        design = inside["solutions"][0]
        has(design, 0.0888, 1.67, 1e-9)
        assert dx.feasibility(**design)["margin"] < 1e-4 * design["BC"]  # either end is a change point
    assert f"{low:.6g}" in outside["message"]


def test_the_least_pressure_angle_is_the_least():
    """Sampled along the rod's length, by events alone."""
    answer = dx.synthesize(stroke=0.1, time_ratio=1.3, max_pressure_angle=0.1)
    assert answer["solutions"] == []
    low, high = dx.synthesize(stroke=0.1, time_ratio=1.3, BC=0.07)["limits"]["BC"]
    rods = np.linspace(low, high, 4001)[1:-1]
    angles = [
        dx.events(**dx.synthesize(stroke=0.1, time_ratio=1.3, BC=rod)["solutions"][0])["max_pressure_angle"]
        for rod in rods[::8]
    ]
    least = answer["limits"]["max_pressure_angle"][0]
    assert least <= min(angles)
    assert least == pytest.approx(min(angles), rel=1e-4)
    for angle in (least * (1 + 1e-6), 1.2, 1.5):
        result = dx.synthesize(stroke=0.1, time_ratio=1.3, max_pressure_angle=angle)["solutions"]
        assert len(result) == 2
        for design in result:
            assert has(design, 0.1, 1.3)["max_pressure_angle"] == pytest.approx(angle, rel=1e-12)


def test_in_line():
    (design,) = dx.synthesize(stroke=0.25, time_ratio=1, BC="350 mm")["solutions"]
    assert design == {"ec": 0.0, "AB": 0.125, "BC": 0.35}
    assert dx.synthesize(stroke=0.25, time_ratio=1, AB=0.125)["status"] == 2
    assert dx.synthesize(stroke=0.25, time_ratio=1, AB=0.1)["status"] == 1
    (design,) = dx.synthesize(stroke=0.25, time_ratio=1, max_pressure_angle="20 deg")["solutions"]
    assert design["BC"] == pytest.approx(0.125 / math.sin(math.radians(20)), rel=1e-14)


def test_a_wish_out_of_reach_is_told_with_its_unit():
    for wish, message in (
        ({"max_pressure_angle": "30 deg"}, r"= 0.523599 rad, .* from 0.543636 to 1.5708 rad"),
        ({"BC": "10 mm"}, r"BC = 0.01 m, .* from 0.125 to 1.66801 m"),
        ({"BC": "10 mm", "time_ratio": 1}, r"BC = 0.01 m, .* from 0.125 m on"),
    ):
        result = dx.synthesize(**{"stroke": "250 mm", "time_ratio": 1.1, **wish})
        assert result["status"] == 1
        assert re.fullmatch(f"none: .*{message}", result["message"])


def test_no_time_ratio_of_three():
    answer = dx.synthesize(stroke=0.1, time_ratio=3.0, BC=0.2)
    assert (answer["solutions"], answer["status"]) == ([], 1)
    assert "below 3" in answer["message"]
    (low, high) = dx.synthesize(stroke=0.1, time_ratio=2.999, BC=0.05001)["limits"]["BC"]
    assert high / low < 1.001


def test_numbers_load_nothing():
    code = (
        "import sys, desaxe as dx; dx.synthesize(stroke=0.1, time_ratio=1.2, max_pressure_angle=1.2); "
        "dx.events(ec=0.01, AB=0.04, BC=0.064); dx.feasibility(ec=0.01, AB=0.04, BC=0.064); "
        "print([name for name in ('numpy', 'scipy', 'numba', 'pint') if name in sys.modules])"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        == "[]\n"
    )
