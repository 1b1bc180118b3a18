"""C at points where formulas lose their digits, its solvers, and what it says about itself."""

import ctypes
import math

import numpy as np
import pytest

import desaxe as dx
from tests.compiler.languages.tools import (
    STRICT,
    array_values,
    library,
    point_values,
    pointer,
    run,
    tool,
)
from tests.scenes.export.stress import INPUTS, NAMES, broken, columns, rows, scene

BUILDS = (
    ("gcc", ("-O3", "-march=native")),
    ("clang", ("-O0",)),
    pytest.param(("gcc", ("-O0",)), marks=pytest.mark.thorough),
    pytest.param(("clang", ("-O3", "-march=native")), marks=pytest.mark.thorough),
)
SLIDING = {"ec": 0.02, "AB": 0.04, "BC": 0.064}


@pytest.fixture(scope="module", params=[1, -1])
def sources(request, tmp_path_factory):
    """Branch, and the source."""
    folder = tmp_path_factory.mktemp("c")
    return request.param, dx.compile(scene(request.param), folder / "press", to="c") / "press.c"


@pytest.mark.parametrize("build", BUILDS, ids=lambda build: f"{build[0]}{''.join(build[1])}")
def test_the_promise_is_kept(build, sources):
    """By arrays; one point has the same bits."""
    branch, source = sources
    loaded = library(source, *build)
    given = columns(branch)
    result = array_values(loaded, "press", given, len(NAMES))
    assert not broken(dict(zip(NAMES, result, strict=True)), branch)
    ones = [point_values(loaded, "press", row, len(NAMES))[1] for row in zip(*given, strict=True)]
    np.testing.assert_array_equal(np.array(ones).T, result)


def test_the_header_says_which_results_have_values(tmp_path):
    """Friction and a bad force leave the motion alone, a stall the position; `evaluate` is the same."""
    names, given = ["Y", "V_C", "T_in"], {"theta": 0.6, "omega0": 10.0, "alpha": 1.0, "F_Y": 5.0, "mu": 0.1}
    lengths = {"ec": 0.1, "AB": 0.2, "BC": 0.35}
    content = {
        "outputs": names,
        "mechanism": lengths,
        "masses": {"m_slider": 1.0},
        "motion": {"theta": [0, 1], "omega0": [1, 2], "alpha": [0, 1]},
        "loads": {"F_Y": [0, 1], "mu": [0, 1]},
    }
    place = dx.compile(content, tmp_path / "press", to="c") / "press.c"
    said = " ".join((tmp_path / "press" / "press.h").read_text().replace(" * ", " ").split())
    assert "A result that has no value is NaN, and the status says why; a result that does not depend" in said
    assert "4 bad input, 5 friction jams: no balance of forces, 6 friction: two balances of forces" in said
    loaded, seen = library(place), {}
    rng = np.random.default_rng(5)
    for mu, theta, kind in zip(
        rng.uniform(0, 6, 300), rng.uniform(0, 6, 300), rng.integers(0, 4, 300), strict=True
    ):
        bad = [{"F_Y": math.inf}, {"alpha": -1e3}, {}, {}][kind]
        row = {**given, "theta": theta, "mu": mu, **bad}
        columns = {name: [value, given[name]] for name, value in row.items()}
        result = dx.evaluate([*names, "status"], **columns, **lengths, m_slider=1.0)
        order = ("theta", "omega0", "alpha", "F_Y", "mu")
        status, values = point_values(loaded, "press", [row[name] for name in order], 3)
        assert status == result["status"][0]
        np.testing.assert_allclose(values, [result[name][0] for name in names], rtol=1e-12)
        seen.setdefault(status, set()).add(tuple(np.isfinite(values).tolist()))
    assert seen.pop(0) == {(True, True, True)}
    assert seen.pop(3) == {(True, False, False)}
    assert seen == {status: {(True, True, False)} for status in (4, 5, 6)}


def test_the_header_lists_what_the_step_has_folded_in(tmp_path):
    """Masses of the acceleration, too, which no output needs; of what is left open, nothing."""
    content = {
        "outputs": ["a_C"],
        "mechanism": {"ec": 0.01, "AB": 0.05, "BC": [0.2, 0.3]},
        "motion": {"theta": [1.0, 2.0], "omega": 0.0},
        "masses": {"m_slider": 20.0, "m_crank": 1.5, "I_crank": 0.02},
        "loads": {"mu": 0.3, "F_Y": [0.0, 1.0]},
    }
    place = dx.compile(content, tmp_path / "press", to="c")
    (line,) = (row for row in (place / "press.h").read_text().splitlines() if "Folded in" in row)
    listed = dict(item.split(" = ") for item in line.partition(": ")[2].removesuffix(".").split(", "))
    loaded = library(place / "press.c")
    fixed = {name: float(value.split()[0]) for name, value in listed.items()}
    assert {"I_crank", "m_crank", "m_slider", "mu"} < fixed.keys()
    assert not {"BC", "F_Y", "theta"} & fixed.keys()
    alpha, row = ctypes.c_double(), (ctypes.c_double * 3)(1.0, 0.2, 5.0)
    state = [ctypes.c_double(value) for value in (9.0, 1.0, 3.0)]  # torque, theta, omega
    assert loaded.press_alpha(*state, row, ctypes.byref(alpha)) == 0
    there = {**fixed, "BC": 0.2, "theta": 1.0, "F_Y": 5.0, "omega": 3.0, "alpha": alpha.value}
    assert dx.evaluate("T_in", **there) == pytest.approx(9.0, rel=1e-12)


def test_status(tmp_path):
    loaded = library(dx.compile(scene(), tmp_path / "press", to="c") / "press.c")
    good = {"theta": 1.0, "ec": 0.02, "AB": 0.04, "BC": 0.064, "omega0": 10.0, "alpha": 1.0}
    trials = [
        ({}, 0), ({"BC": 0.01}, 1), ({"theta": -100.0}, 3), ({"theta": math.nan}, 4), ({"BC": -0.064}, 4),
        ({"BC": math.inf}, 4), ({"BC": 0.0}, 4), ({"AB": -0.04}, 4), ({"omega0": math.inf}, 4),
        ({"theta": 100.0, "omega0": 150.0}, 0), ({"theta": 1e9}, 0),
    ]  # fmt: skip
    for change, status in trials:
        row = [(good | change)[name] for name in INPUTS]
        result, values = point_values(loaded, "press", row, len(NAMES))
        assert result == status
        assert status == 0 or math.isnan(values[NAMES.index("V_C")])


def test_names_and_units(sources):
    loaded = library(sources[1])

    def texts(table):
        result, items = [], (ctypes.c_char_p * 20).in_dll(loaded, f"press_{table}")
        for item in items:
            if item is None:
                return result
            result.append(item.decode())
        return None

    assert texts("inputs") == list(INPUTS)
    assert texts("outputs") == list(NAMES)
    assert texts("input_units") == ["rad", "m", "m", "m", "rad/s", "rad/s^2"]
    assert texts("output_units") == [dx.quantities()[name].unit for name in NAMES]


def is_well_conditioned(there):
    """True unless a dead centre or change point is so close that an ulp of the angle changes the rates."""
    result = dx.evaluate(["Y_wrt_theta", "Y_wrt_theta_theta"], **there)
    return abs(result["Y_wrt_theta"]) > 0.05 * there["AB"] > 0.001 * abs(result["Y_wrt_theta_theta"])


def test_inverse(sources):
    """The angles of `dx.inverse`, which the loop closure checks, and rates that give the slider's back."""
    branch, source = sources
    loaded = library(source)
    for row in rows(branch)[::3]:
        lengths = {name: row[name] for name in ("ec", "AB", "BC")}
        Y = dx.evaluate("Y", theta=row["theta"], branch=branch, **lengths)
        if not math.isfinite(Y) or max(map(abs, lengths.values())) > 1e100:
            continue
        expected = dx.inverse(Y=Y, V_C=0.3, a_C=-2.0, branch=branch, **lengths)
        given = np.array([row[name] for name in INPUTS])
        theta, omega, alpha = (np.empty(2) for _ in range(3))
        status = loaded.press_inverse(
            *map(ctypes.c_double, (Y, 0.3, -2.0)), *map(pointer, (given, theta, omega, alpha))
        )
        if status == expected["status"]:  # at a dead centre, a last bit decides
            np.testing.assert_allclose(theta, expected["theta"], rtol=1e-6, atol=1e-7)
        else:
            assert {status, expected["status"]} <= {0, 1, 2}
            continue
        for angle, rate, other in zip(theta, omega, alpha, strict=True):
            there = {**lengths, "theta": angle, "branch": branch}
            if math.isfinite(rate) and is_well_conditioned(there):
                back = dx.evaluate(["V_C", "a_C"], **there, omega=rate, alpha=other)
                assert back["V_C"] == pytest.approx(0.3, rel=1e-6)
                assert back["a_C"] == pytest.approx(-2.0, rel=1e-6, abs=1e-6 * rate**2 * row["AB"])


def test_limits(sources):
    """Those of `feasibility`, in each of its cases."""
    loaded = library(sources[1])
    designs = [
        (0.02, 0.04, 0.064), (0.125, 0.125, 0.375), (-0.1, 0.3, 0.35), (0.1, 0.3, 0.35), (0.0, 0.4, 0.3),
        (0.1, 0.5, 0.3), (-0.1, 0.5, 0.3), (0.6, 0.3, 0.5), (-0.6, 0.3, 0.5), (5.0, 0.3, 0.5),
        (0.7, 0.0, 0.5), (0.3, 0.0, 0.5), (0.125, 0.125, 0.25),
    ]  # fmt: skip
    for ec, AB, BC in designs:
        given = np.array([0.0, ec, AB, BC, 0.0, 0.0])
        angles = np.empty(4)
        status = loaded.press_limits(pointer(given), pointer(angles))
        expected = dx.feasibility(ec=ec, AB=AB, BC=BC)
        flat = [angle for interval in expected["theta_intervals"] for angle in interval]
        assert angles.tolist()[: len(flat)] == pytest.approx(flat, rel=4e-15)
        assert np.isnan(angles[len(flat) :]).all()
        assert status == expected["status"]
    bad = np.array([0.0, 0.0, -1.0, 1.0, 0.0, 0.0])
    assert loaded.press_limits(pointer(bad), pointer(angles)) == 4


MAIN = """#include <stdio.h>
#include "press.h"
int main(void) {
  double in[6], strip[6][300], out[6][300], values[6], theta[2], omega[2], alpha[2], angles[4];
  const double *ins[6];
  double *outs[6];
  for (int k = 0; k < 6; k++) {
    ins[k] = strip[k];
    outs[k] = out[k];
    for (int j = 0; j < 300; j++) strip[k][j] = k == 3 ? 0.01 * j - 1.0 : 0.1 * (j % 7) - 0.2 * k;
  }
  press_array(300, ins, outs);
  press_array(0, ins, outs);
  for (int j = 0; j < 300; j++) {
    for (int k = 0; k < 6; k++) in[k] = strip[k][j];
    press_point(in, values);
    press_inverse(0.1 * j - 10.0, 1.0, 1.0, in, theta, omega, alpha);
    press_limits(in, angles);
  }
  puts(press_outputs[0]);
  return 0;
}
"""


SANITIZERS = {
    "gcc": ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g"),
    "clang": ("-fsanitize=undefined,float-cast-overflow", "-fsanitize-trap=all"),  # wants no library
}


@pytest.mark.parametrize("compiler", SANITIZERS)
def test_sanitizers_find_nothing(compiler, sources):
    source, checks = sources[1], SANITIZERS[compiler]
    (source.parent / "main.c").write_text(MAIN, encoding="utf-8")
    program = source.parent / f"main_{compiler}"
    run(tool(compiler), *STRICT, *checks, source, source.parent / "main.c", "-o", program, "-lm")
    assert run(program) == "Y\n"


SCENES = {
    "steady": {
        "outputs": ["status", "V_C", "a_C"], "mechanism": SLIDING, "motion": {"theta": [0, 1], "omega0": 3},
    },
    "wide": {
        "outputs": ["V_C"], "mechanism": SLIDING | {"ec": 0.001},
        "motion": {"theta": [0, 1], "omega0": [1, 2]},
    },
    "state": {
        "outputs": ["a_C_wrt_omega", "phi", "omega"], "mechanism": SLIDING,
        "motion": {"theta": [0, 1], "omega": [1, 2], "alpha": 2},
    },
    "forces": {
        "outputs": ["T_in", "N_C", "status"], "mechanism": SLIDING,
        "motion": {"theta": [0, 1], "omega0": 250},
        "masses": {"m_slider": [0.4, 0.8]}, "loads": {"F_Y": -50, "mu": [0.1, 0.2]},
    },
    "extended": {
        "outputs": ["V_C", "a_C", "phi"], "mechanism": SLIDING | {"ec": [0.02, 0.024]},
        "motion": {"theta": [0, 1], "omega0": 3}, "accuracy": "extended",
    },
    "no_axis": {"outputs": ["V_C", "Y"], "mechanism": SLIDING, "motion": {"theta": 1, "omega0": 3}},
}  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_values_of_other_scenes(name, tmp_path):
    """Folded numbers, states, forces, twice the digits: what `evaluate` gives, which truth checks."""
    content = dx.scene(SCENES[name]).content
    dx.compile(SCENES[name], tmp_path / "made", to="c")
    loaded = library(tmp_path / "made" / "made.c", "gcc", ("-O2",))
    order = ("theta", "ec", "omega0", "omega", "m_slider", "mu")
    axes = [n for n in order if isinstance(content.inputs.get(n), tuple)]
    rng = np.random.default_rng(3)
    given = {
        n: rng.uniform(*content.inputs[n], 300) if n != "theta" else rng.uniform(-9, 9, 300) for n in axes
    }
    fixed = {n: x for n, x in content.inputs.items() if n not in axes}
    outputs = list(content.outputs)
    status, one = point_values(loaded, "made", [given[n][0] for n in axes], len(outputs))
    expected = dx.evaluate([*outputs, "status"], **given, **fixed, accuracy=content.accuracy)
    assert status == np.ravel(expected["status"])[0]
    limit = 0 if name == "extended" else 1e-12
    for place, output in enumerate(outputs):
        np.testing.assert_allclose(one[place], np.ravel(expected[output])[0], rtol=limit)
    if axes:
        result = array_values(loaded, "made", [given[n] for n in axes], len(outputs))
        for values, output in zip(result, outputs, strict=True):
            np.testing.assert_allclose(values, expected[output], rtol=limit, err_msg=output)
