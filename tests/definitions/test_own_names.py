"""The name of an own quantity changes nothing: not its type, and not what else a file or a call has."""

import math
from contextlib import ExitStack, nullcontext

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.names import INTERNAL
from desaxe.runtime.kernels import REACH
from desaxe.runtime.specialise import KEPT
from tests.compiler.languages.tools import es_module, imported, jax_in_doubles, library, point_values
from tests.definitions.expressions import defined

POINT = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 3.0}
OF_STATUS = ("static_status", "status_of_drive", "out_status", "force_status_now")
# Names of C and Octave, and of what a JavaScript function has for itself: every word is in `test_words`.
HOSTILE = ("double", "NAN", "errno", "end", "value", "place")


@pytest.fixture
def doubled():
    """Define names as twice the speed, until the test is over."""
    with ExitStack() as stack:
        yield lambda names: [stack.enter_context(defined(name, "2*V_C")) for name in names]


def scene(*names):
    return {
        "outputs": [*names, "V_C", "status"],
        "mechanism": {"ec": [0.01, 0.02], "AB": POINT["AB"], "BC": POINT["BC"]},
        "motion": {"theta": [0.0, 1.0], "omega0": POINT["omega0"]},
    }


def test_names_with_status_in_them_are_no_status(doubled, tmp_path):
    """At an angle that the kernel cannot reduce, where its answers are repaired; in C, too."""
    theta = np.array([0.3, 1e17, -3e18])
    names = [*doubled(OF_STATUS), "V_C", "status"]
    by_function = dx.function(names, inputs=("theta",), **POINT)(theta)
    both = dx.evaluate(names, theta=theta, **POINT)
    for *values, speed, status in (by_function, [*both.values()]):
        np.testing.assert_array_equal(values, [2.0 * speed] * len(OF_STATUS))
        assert status.dtype == np.int8
        assert not status.any()
    source = dx.compile(scene(*OF_STATUS), tmp_path / "press", to="c") / "press.c"
    loaded, count = library(source), len(names)
    status, out = point_values(loaded, "press", (1.0, 0.01), count)
    speed = dx.evaluate("V_C", theta=1.0, **POINT)
    assert (status, out[-1]) == (0, 0.0)
    assert out[:-1] == pytest.approx([2.0 * speed] * len(OF_STATUS) + [speed], rel=1e-14)
    assert point_values(loaded, "press", (math.nan, 0.01), count)[0] == 4


def test_a_plan_counts_it_as_a_value():
    with defined("static_status", "2*V_C"):
        one = dx.explain(dx.scene(scene("static_status"))).as_dict()["memory"]
    with defined("static_speed", "2*V_C"):
        other = dx.explain(dx.scene(scene("static_speed"))).as_dict()["memory"]
    assert one == other


def test_names_that_the_library_requests_itself_are_taken():
    assert {*REACH, *KEPT.values()} < set(INTERNAL)
    for name in INTERNAL:
        with pytest.raises(ValueError, match=f"{name!r} is a name of desaxe already"):
            dx.define(name, "2*V_C")


def test_other_names_are_right_in_javascript(doubled, tmp_path):
    place = dx.compile(scene(*doubled(HOSTILE)), tmp_path / "press.js", to="javascript")
    expected = pytest.approx(2.0 * dx.evaluate("V_C", theta=0.7, **POINT), rel=1e-14)
    calls = [["evaluate", {"theta": 0.7, "ec": 0.01}], *([name, 0.7, 0.01] for name in HOSTILE)]
    every, *alone = es_module(place, calls)
    assert every["status"] == 0
    assert [every[name] for name in HOSTILE] == alone == [expected] * len(HOSTILE)


@pytest.mark.parametrize(
    ("to", "name"),
    [
        ("javascript", "evaluate"), ("javascript", "Infinity"), ("javascript", "default"), ("jax", "asarray"),
        ("jax", "OUTPUTS"), ("numba", "array"), ("numba", "float64"),
    ],
)  # fmt: skip
def test_a_name_that_would_hide_a_part_of_the_module_is_refused(to, name, tmp_path):
    file = tmp_path / ("press.js" if to == "javascript" else "press.py")
    refused = pytest.raises(ValueError, match=f"outputs: {name!r}: a word of the module's language")
    with defined(name, "2*V_C"), refused:
        dx.compile(scene(name), file, to=to)


@pytest.mark.parametrize("to", [pytest.param("numba", marks=pytest.mark.thorough), "jax"])
def test_other_names_are_right_in_python(to, doubled, tmp_path):
    at, names = (0.7, 0.01), doubled(["kernel", "length", "x"])
    made = imported(dx.compile(scene(*names), tmp_path / f"press_{to}.py", to=to))
    expected = pytest.approx(2.0 * dx.evaluate("V_C", theta=at[0], **POINT), rel=1e-13)
    with jax_in_doubles() if to == "jax" else nullcontext():
        assert [float(getattr(made, name)(*at)) for name in names] == [expected] * len(names)
    assert to == "jax" or made.point(*at)[: len(names)] == tuple(getattr(made, name)(*at) for name in names)


def test_a_function_of_a_design_may_be_called_skipped():
    def points_skipped(design):
        return 2.5 * design["ec"], {"ec": 2.5}

    inputs = {"theta": np.linspace(0.0, 6.0, 9), "ec": np.array([0.01, 0.02]), "AB": 0.04, "BC": 0.064}
    reduce = {"theta": ["max", points_skipped]}
    result = dx.grid("V_C", omega0=3.0, reduce=reduce, **inputs)
    assert result["V_C_skipped"].dtype == np.int64
    np.testing.assert_allclose(result["points_skipped"], [0.025, 0.05])


def test_harmonics_of_a_name_that_ends_in_at_rest():
    load = dx.over_theta([0.0, 2.0, 4.0], [-50.0, -200.0, -80.0], kind="linear")
    design = {**POINT, "m_slider": 2.0, "F_Y": load}
    with defined("torque_at_rest", "2*T_in"):
        result = dx.harmonics("torque_at_rest", orders=3, **design)
    expected = dx.harmonics("T_in", orders=3, **design)
    np.testing.assert_allclose(result["cos"], 2.0 * expected["cos"], rtol=1e-12)
