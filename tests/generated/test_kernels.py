"""The committed kernels: self-contained modules that give what `desaxe.evaluate` gives."""

import inspect
import os
import random
import shutil
import subprocess
import sys
from importlib import import_module
from math import inf, nan, nextafter
from pathlib import Path

import mpmath
import numpy as np
import pytest
from desaxe.derive.groups import GROUPS
from desaxe.derive.write import module_of
from desaxe.generated.program import law

import desaxe as dx
from desaxe.compiler.program import Line, Program
from desaxe.compiler.lowering import Limits, guarded_for_loops, nest_of_two_forms
from desaxe.mechanism.constants import constants
from desaxe.mechanism.program import _text
from desaxe.runtime.executor import CompiledKernel
from tests.compiler.programs import LINKS, LOADS
from tests.derive.derived import derivation
from tests.effort import cases, first

ROOT = Path(__file__).parents[2]
NAMES = [group.name for group in GROUPS]
MAIN = ("motion", "sensitivities")  # the others compile in the thorough run alone
EACH = first(2, sorted(NAMES, key=lambda name: name not in MAIN))
OUTPUTS = {group.name: group.outputs for group in GROUPS}
INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")


def evaluate(group, **inputs):
    """The function of a group; what it does not take is left out."""
    function = import_module(f"desaxe.generated.{group}").evaluate
    taken = inspect.signature(function).parameters
    return function(**{name: value for name, value in inputs.items() if name in taken})


def points(count, seed=7):
    """Random points: mechanisms that turn fully, and a few that cannot be assembled at all."""
    rng = np.random.default_rng(seed)
    BC = rng.uniform(0.2, 1.0, count)
    columns = {
        "theta": rng.uniform(-9, 9, count),
        "ec": BC * rng.uniform(-0.3, 0.3, count),
        "AB": BC * rng.uniform(0.05, 0.5, count),
        "BC": BC,
        "omega0": rng.choice([-1, 1], count) * rng.uniform(50, 200, count),
        "alpha": rng.uniform(-50, 50, count),
        **{name: rng.uniform(0.1, 2.0, count) for name in ("m_crank", "m_rod", "m_slider")},
        **{name: rng.uniform(0.001, 0.1, count) for name in ("I_crank", "I_rod")},
        **{name: rng.uniform(-50, 50, count) for name in ("F_X", "F_Y", "g_X", "g_Y")},
        **{"r_crank": BC * rng.uniform(-0.2, 0.5, count), "r_rod": BC * rng.uniform(0, 1, count)},
        "mu": rng.uniform(0, 0.3, count),
    }
    columns["ec"][::7] = 2 * BC[::7]
    return columns


BAD = [
    ("theta", nan),
    ("ec", inf),
    ("AB", -0.1),
    ("BC", -0.35),
    ("BC", 0.0),
    ("BC", inf),
    ("omega0", nan),
    ("alpha", -inf),
]


@pytest.mark.parametrize("group", EACH)
@pytest.mark.parametrize("branch", [1, pytest.param(-1, marks=pytest.mark.thorough)])
def test_a_kernel_gives_what_evaluate_gives(group, branch):
    """Where there is nothing to give, too: NaN, and the same status."""
    columns, taken = (
        points(60),
        inspect.signature(import_module(f"desaxe.generated.{group}").evaluate).parameters,
    )
    for place, (name, value) in enumerate(BAD):
        columns[name][10 + place] = value
    columns = {name: column for name, column in columns.items() if name in taken}
    result = evaluate(group, **columns, branch=branch)
    expected = dx.evaluate(list(OUTPUTS[group]), **columns, branch=branch)
    for name in OUTPUTS[group]:
        assert np.isnan(expected[name]).any() or result[name].dtype == np.int8
        scale = np.nanmax(np.abs(expected[name]))
        np.testing.assert_allclose(result[name], expected[name], rtol=1e-11, atol=1e-13 * scale, err_msg=name)


@pytest.mark.parametrize("group", first(2, sorted(GROUPS, key=lambda g: g.name not in MAIN[:2])), ids=lambda group: group.name)
def test_both_ways_to_machine_code_have_the_same_bits(group):
    """The lines of a module by numba, and by the executor of the library: next to change points, too."""
    count, rng = cases(1_500, 20_000), np.random.default_rng(7)
    columns = {n: c for n, c in points(count).items()}
    columns["BC"][::2] = (columns["AB"] + np.abs(columns["ec"]))[::2] * (
        1.0 + 10.0 ** rng.uniform(-16, -1, count)[::2]
    )
    module, _ = module_of(derivation(), group, "")
    columns = {n: columns[n] for n in (symbol.name for symbol in module.inputs)}
    stable, plain = (
        guarded_for_loops(program, (), Limits({}), constants())
        for program in (module.forms.stable, module.forms.plain or module.forms.stable)
    )
    kernel = nest_of_two_forms(
        plain, stable, module.forms.test or WIDE, len(group.outputs), dict.fromkeys(columns, 0), 1
    )
    outs = [np.empty(count, module_kind(group, name)) for name in group.outputs]
    CompiledKernel(kernel).run(columns | {"branch": 1.0}, outs)
    for name, result, bits in zip(group.outputs, evaluate(group.name, **columns).values(), outs, strict=True):
        np.testing.assert_array_equal(result, bits, err_msg=name)


WIDE = Program(("ec",), (Line("wide", "lt", ("ec", -inf)),), ("wide",), {})  # never: the stable form alone


def module_kind(group, name):
    return import_module(f"desaxe.generated.{group.name}").OUTPUTS[name]


@pytest.mark.parametrize("group", EACH)
def test_it_broadcasts(group):
    columns = points(5)
    grid = {name: values[:, None] for name, values in columns.items()} | {"theta": np.array([0.1, 0.2, 0.3])}
    result = evaluate(group, **grid)
    for column, theta in enumerate(grid["theta"]):
        row = evaluate(group, **columns | {"theta": float(theta)})
        assert {name: values.shape for name, values in result.items()} == dict.fromkeys(OUTPUTS[group], (5, 3))
        assert all(np.array_equal(result[name][:, column], row[name], equal_nan=True) for name in row)


@pytest.mark.parametrize("group", EACH)
def test_its_outputs_are_those_of_the_group(group):
    module = import_module(f"desaxe.generated.{group}")
    assert OUTPUTS[group] == tuple(module.OUTPUTS)
    assert {name: dx.quantities()[name].unit for name in module.OUTPUTS} == {
        n: module.UNITS[n] for n in module.OUTPUTS
    }


@pytest.mark.parametrize("group", EACH)
def test_an_angle_of_any_size_is_taken(group):
    """Beyond the reach of the polynomials, too: as the angle that mpmath leaves of it within a turn."""
    limit, design = constants().limit, {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 10.0}
    design |= {"alpha": 0.0, "r_crank": 0.06, "r_rod": 0.2}
    theta = [limit, nextafter(limit, inf), -2 * limit, 1e12, 1e300]
    with mpmath.workdps(340):
        turned = [float(mpmath.mpf(angle) % (2 * mpmath.pi)) for angle in theta]
    result, right = (evaluate(group, theta=np.array(angles), **design) for angles in (theta, turned))
    for name in OUTPUTS[group]:
        if name.endswith("_wrt_alpha"):
            continue  # the law has the angle itself in it
        scale = np.abs(right[name]).max()
        np.testing.assert_allclose(result[name], right[name], rtol=1e-12, atol=1e-13 * scale, err_msg=name)


@pytest.mark.parametrize("group", EACH)
def test_numbers_and_integers_are_taken(group):
    point = {
        "theta": 1,
        "ec": 0,
        "AB": 1,
        "BC": 3,
        "omega0": 2,
        "alpha": 0,
        "m_rod": 5,
        "r_crank": 0,
        "r_rod": 2,
    }
    result = evaluate(group, **point)
    expected = evaluate(group, **{name: float(value) for name, value in point.items()})
    assert all(np.ndim(result[name]) == 0 and result[name] == expected[name] for name in OUTPUTS[group])


@pytest.mark.parametrize(
    "group", [name if name == "motion" else pytest.param(name, marks=pytest.mark.thorough) for name in NAMES]
)
def test_a_grid_a_point_and_a_loop_of_ones_own_give_what_arrays_give(group):
    """Designs of both forms; each axis is the innermost once, with read-only and strided inputs and outputs."""
    module = import_module(f"desaxe.generated.{group}")
    numbers = {name: float(column[1]) for name, column in points(2).items()}
    numbers = {n: v for n, v in numbers.items() if n in inspect.signature(module.evaluate).parameters}
    ec = numbers["BC"] * np.array([0.0, 0.3, 0.6, 2.0])
    ec.flags.writeable = False
    for axes in (
        {"theta": np.linspace(0, 6, 1030), "ec": ec},
        {"theta": np.linspace(0, 6, 14)[::2], "BC": ec + 0.1},
    ):
        inputs = numbers | axes
        order = [name for name in inspect.signature(module.grid).parameters if name in axes]
        meshes = dict(zip(order, np.meshgrid(*(inputs[n] for n in order), indexing="ij"), strict=True))
        expected = module.evaluate(**numbers | meshes)
        shape = expected[OUTPUTS[group][0]].shape
        out = {name: np.empty((*shape, 2), kind)[..., 0] for name, kind in module.OUTPUTS.items()}
        assert module.grid(**inputs, out=out) == out
        fresh = module.grid(**inputs)
        for name in OUTPUTS[group]:
            np.testing.assert_array_equal(out[name], expected[name], err_msg=name)
            np.testing.assert_array_equal(fresh[name], expected[name], err_msg=name)
        for index in [(0, 0), (3, 1), (5, 2), (6, 3)]:
            point = module.point(**numbers | {name: float(mesh[index]) for name, mesh in meshes.items()})
            np.testing.assert_array_equal(point, [expected[name][index] for name in OUTPUTS[group]])


def test_a_centre_of_mass_halfway_along_its_link_has_no_dimension_of_a_grid():
    from desaxe.generated.forces import grid

    rest = {"theta": 1.0, "ec": 0.01, "omega0": 10.0, "m_rod": 2.0} | dict.fromkeys(("m_crank", "m_slider"), 1.0)
    rest |= dict.fromkeys(("I_crank", "I_rod", "alpha"), 0.1)
    AB, BC = np.array([0.1, 0.12, 0.13]), np.array([0.4, 0.5])
    result = grid(AB=AB, BC=BC, **rest)["T_in"]
    for k, index in enumerate(np.ndindex(3, 2)):
        a, b = AB[index[0]], BC[index[1]]
        right = dx.evaluate("T_in", AB=a, BC=b, r_crank=a / 2, r_rod=b / 2, **rest)
        assert result.shape == (3, 2) and result.flat[k] == pytest.approx(right, rel=1e-12)


def test_a_point_is_called_from_a_loop_of_ones_own():
    import numba
    from desaxe.generated.motion import evaluate, point

    @numba.njit
    def largest(theta, AB, BC):
        most = 0.0
        for angle in theta:
            most = max(most, abs(point(angle, 0.01, AB, BC, 100.0)[2]))
        return most

    theta = np.linspace(0, 6, 50)
    assert largest(theta, 0.1, 0.3) == np.abs(evaluate(theta, 0.01, 0.1, 0.3, 100.0)["a_C"]).max()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"theta": "1"}, "theta: expected real numbers, got <U1"),
        ({"branch": 2}, "branch = 2: it is \\+1 or -1"),
        ({"out": {"Y": np.empty(3)}}, "out= is a dict with the keys Y, V_C, a_C, got Y"),
        (
            {"out": dict.fromkeys(("Y", "V_C", "a_C"), np.empty(2))},
            r"out= for Y: expected float64 of the shape \(\)",
        ),
    ],
)
def test_what_is_wrong_is_named(change, message):
    from desaxe.generated.motion import evaluate, grid

    for call in (evaluate, grid):
        with pytest.raises((TypeError, ValueError), match=message):
            call(**{"theta": 1.0, "ec": 0.0, "AB": 0.1, "BC": 0.3, "omega0": 1.0} | change)


@pytest.mark.thorough
@pytest.mark.parametrize("first", ["generated", pytest.param("desaxe.generated", marks=pytest.mark.thorough)])
def test_a_clone_has_one_name_for_its_kernels_and_the_other_says_so(first, tmp_path):
    """Whatever the order: numba keeps machine code by file, and its content by the module's name."""
    code = f"""
import importlib, sys
sys.path.insert(0, {str(ROOT)!r})
for name in dict.fromkeys(({first!r}, "generated", "desaxe.generated")):
    try:
        importlib.import_module(name + ".position").evaluate(1.0, 0.0, 0.1, 0.3)
        print("works", name)
    except ImportError as error:
        print(error)
"""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    for _ in range(2):
        run = subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
        )
        assert sorted(run.stdout.splitlines()) == [
            "in a clone of desaxe its kernels are desaxe.generated: import them from there",
            "works desaxe.generated",
        ]


@pytest.mark.thorough
def test_a_copy_of_ones_own_may_have_any_name(tmp_path):
    shutil.copytree(ROOT / "generated", tmp_path / "generated", ignore=shutil.ignore_patterns("__pycache__"))
    code = "from generated import position; print(position.evaluate(0.0, 0.0, 0.1, 0.3)['Y'])"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert float(run.stdout) == 0.1 + 0.3


def feasible_points(count):
    rng = random.Random("law")
    for _ in range(count):
        BC, speed = rng.uniform(0.2, 1.0), rng.choice([-1, 1]) * rng.uniform(50, 200)
        values = rng.uniform(-9, 9), BC * rng.uniform(-0.3, 0.3), BC * rng.uniform(0.05, 0.6), BC, speed
        yield dict(zip(INPUTS, (*values, rng.choice([0.0, rng.uniform(-50, 50)])), strict=True))


@pytest.mark.parametrize("branch", [1, -1])
def test_the_text_itself_runs_as_python(branch):
    names = _text("program").outputs()
    public = list(dx.quantities())
    for point in feasible_points(25):
        result = dict(zip(names, law(**point, **LINKS, **LOADS, branch=float(branch)), strict=True))
        result["status"] = result["force_status"]
        expected = dx.evaluate(public, **point, **LINKS, **LOADS, branch=branch)
        assert {name: result[name] for name in public} == expected
