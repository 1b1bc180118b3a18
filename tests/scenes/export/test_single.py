"""C in single precision: truth at the rounded inputs, lengths that are folded in, solvers and steps."""

import ctypes
import math
import random
import zipfile
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.interpret import ieee_single, to_single
from desaxe.compiler.languages.c import C
from desaxe.compiler.languages.c.single import in_single
from desaxe.compiler.program import Line, Program
from desaxe.mechanism.constants import single_constants
from desaxe.oracle import force_truth
from desaxe.oracle.truth import conditions, truth
from tests.compiler.languages.modules import module, written
from tests.compiler.languages.tools import array_values, library, point_values, pointer
from tests.effort import cases
from tests.scenes.export import single
from tests.scenes.export.stress import INPUTS, NAMES, scene

BUILDS = (("gcc", ("-O3", "-march=native"), True), ("clang", ("-O0",), False))
FLOAT = ctypes.c_float


def floats(*values):
    return np.array(values, np.float32)


def point(loaded, row, count, name="press"):
    """The status and the outputs of `press_point`."""
    return point_values(loaded, name, row, count, np.float32)


def build(content, folder, compiler="gcc", options=("-O2",), libm=True):
    place = dx.compile(content, folder / "press", to="c", float=True, libm=libm)
    return library(place / "press.c", compiler, options, libm)


@pytest.mark.sampled
@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("how", BUILDS, ids=lambda how: how[0])
def test_the_promise_is_kept(how, branch, tmp_path):
    """Error in float ulp over 1 + condition: 8, where 64 are promised; a point has the bits of an array."""
    each = cases(2, 12, 400)
    loaded, columns = build(scene(branch), tmp_path, *how), single.columns(branch, each)
    found = array_values(loaded, "press", columns, len(NAMES))
    errors = [*single.errors(dict(zip(NAMES, found, strict=True)), branch, each)]
    assert len(errors) > 2 * columns[0].size
    assert not [error for error in errors if not error[3] < single.LIMIT]
    ones = [point(loaded, row, len(NAMES))[1] for row in zip(*columns, strict=True)]
    np.testing.assert_array_equal(np.array(ones, np.float32).T, found)


@pytest.mark.sampled
def test_lengths_that_are_folded_in(tmp_path):
    """Some or all of the lengths of designs near a change point: those of the scene, rounded to float."""
    rng = random.Random(24)
    for case in range(cases(3, 12, 100)):
        at = single.near_change_point(rng)
        lengths = {name: at[name] * 0.1 for name in ("ec", "AB", "BC")}  # not floats
        left = rng.sample([*lengths], rng.randrange(3))
        content = scene(at["branch"], ["Y", "V_C", "a_C_wrt_ec"])
        content["mechanism"] |= {n: lengths[n] if n not in left else [0.1, 0.2] for n in lengths}
        loaded = build(content, tmp_path / str(case))
        for _ in range(10):
            there = single.rounded(at | lengths | {"theta": rng.uniform(-9, 9)})
            order = [name for name in INPUTS if name not in lengths or name in left]
            _, values = point(loaded, [there[name] for name in order], 3)
            for name, value in zip(content["outputs"], values, strict=True):
                exact = truth(name, **there)
                if not mpmath.isnan(exact):
                    bound = single.LIMIT * (1 + conditions(name, **there))
                    assert single.ulps(value, exact) < bound, (name, there, left)


@pytest.mark.sampled
def test_forces(tmp_path):
    names, rng = ["T_in", "N_C", "F_A_Y", "kinetic_energy", "T_in_wrt_ec"], random.Random(7)
    masses = {"m_slider": [0.3, 0.4], "m_rod": 0.3, "I_crank": 3e-3}
    loads = {"F_Y": [0, 5], "g_Y": -9.81, "mu": [0, 0.1]}
    content = scene(1, names, masses=masses, loads=loads)
    content["mechanism"]["AB"] = 0.13
    loaded, seen = build(content, tmp_path), 0
    for _ in range(cases(25, 60, 5000)):
        at = single.draw(rng.choice(["generic", "near_change_point", "dead_centre"]), 1, rng.random())[0]
        free = {"m_slider": rng.uniform(0, 2), "F_Y": rng.uniform(-99, 99), "mu": rng.choice((0, 0.2))}
        fixed = {"AB": 0.13, "m_rod": 0.3, "I_crank": 3e-3, "g_Y": -9.81}
        there = single.rounded(at | free | fixed | {"branch": 1})
        order = [*(n for n in INPUTS if n != "AB"), "m_slider", "F_Y", "mu"]
        status, values = point(loaded, [there[name] for name in order], len(names))
        if status == 0:
            seen += 1
            for name, value in zip(names, values, strict=True):
                exact = force_truth.truth(name, **there)
                condition = force_truth.conditions(name, others=force_truth.OTHERS, **there)
                if mpmath.isfinite(exact) and condition < 1e5:
                    assert single.ulps(value, exact) < single.LIMIT * (1 + condition), (name, there)
    assert seen > 10


@pytest.mark.parametrize("libm", [True, False])
def test_next_to_quarter_turns_sine_and_cosine_keep_their_digits(libm, tmp_path):
    """Each of the floats around whole quarter turns up to 100 rad."""
    lines = tuple(Line(op, op, ("x",)) for op in ("sin", "cos", "sqrt"))
    program = Program(("x",), lines, ("sin", "cos", "sqrt"), {})
    made = module(program)._replace(single=True, constants=single_constants())
    loaded = library(written(C(), made, tmp_path, not libm), libm=libm)
    with mpmath.workdps(60):
        for quarter in range(-64, 65):
            for step in range(-2, 3):
                angle = np.float32(quarter * math.pi / 2)
                for _ in range(abs(step)):
                    angle = np.nextafter(angle, np.float32(math.copysign(math.inf, step)))
                _, values = point(loaded, [angle], 3, "made")
                exact = mpmath.sin(float(angle)), mpmath.cos(float(angle))
                for value, wanted in zip(values, exact, strict=False):
                    assert value == wanted or single.ulps(value, wanted) < 2


def test_angles_of_the_solvers(tmp_path):
    """Those of `inverse` and `feasibility`, to what a float of an angle is worth."""
    loaded = build(scene(), tmp_path)
    rng = np.random.default_rng(5)
    for _ in range(100):
        lengths = [float(np.float32(x)) for x in rng.uniform((-0.4, 0.1, 0.2), (0.4, 0.5, 1.0))]
        given = dict(zip(("ec", "AB", "BC"), lengths, strict=True))
        row, angles = floats(0.0, *lengths, 0.0, 0.0), np.empty(4, np.float32)
        status = loaded.press_limits(pointer(row), pointer(angles))
        wanted = dx.feasibility(**given)
        flat = [angle for interval in wanted["theta_intervals"] for angle in interval]
        assert status == wanted["status"]
        assert angles.tolist()[: len(flat)] == pytest.approx(flat, abs=2e-6)
        Y = float(np.float32(rng.uniform(0.1, 1.0)))
        theta, omega, alpha = (np.empty(2, np.float32) for _ in range(3))
        status = loaded.press_inverse(
            FLOAT(Y), FLOAT(0.3), FLOAT(-2.0), *map(pointer, (row, theta, omega, alpha))
        )
        wanted = dx.inverse(Y=Y, **given)
        assert status == wanted["status"]
        np.testing.assert_allclose(theta, wanted["theta"], atol=2e-3)
        for angle in theta[np.isfinite(theta)]:
            there = dx.evaluate(["Y", "Y_wrt_theta"], theta=float(angle), **given)
            assert there["Y"] == pytest.approx(Y, abs=2e-7 * (2 + abs(there["Y_wrt_theta"]) * math.tau))


def test_steps_follow_the_motion(tmp_path):
    """With friction, from rest to rest: what doubles give, to single precision."""
    content = {
        "outputs": ["V_C"], "mechanism": {"ec": 0.01, "AB": 0.04, "BC": [0.1, 0.2]},
        "motion": {"theta": [0, 1], "omega": [0, 1]}, "masses": {"m_slider": 0.4, "I_crank": 2e-3},
        "loads": {"F_X": 30, "F_Y": 4, "mu": 0.3},
    }  # fmt: skip
    loaded = build(content, tmp_path)
    given = {"ec": 0.01, "AB": 0.04, "BC": 0.1, **content["masses"], **content["loads"]}
    wanted = dx.simulate(torque=0.0, t_end=0.5, theta0=1.0, omega_start=8.0, **given)
    assert wanted["status"] == 1
    row, theta, omega = pointer(floats(0, 0.1, 0)), FLOAT(1.0), FLOAT(8.0)
    for _ in range(1000):
        assert loaded.press_step(FLOAT(5e-4), FLOAT(0.0), ctypes.byref(theta), ctypes.byref(omega), row) == 0
    assert omega.value == 0.0
    assert theta.value == pytest.approx(wanted["theta"][-1], abs=1e-3)
    alpha = FLOAT(7.0)
    assert loaded.press_alpha(FLOAT(9.0), theta, FLOAT(20.0), row, ctypes.byref(alpha)) == 0
    there = {**given, "theta": theta.value, "omega": 20.0}
    assert dx.evaluate("T_in", alpha=alpha.value, **there) == pytest.approx(9.0, abs=1e-4)


def test_folding_is_that_of_single_precision():
    """As NumPy's float32 computes; error terms are exact."""
    rng = random.Random(1)
    for _ in range(300):
        a, b = (to_single(rng.uniform(-9, 9) * 10 ** rng.randrange(-6, 7)) for _ in range(2))
        x, y = np.float32(a), np.float32(b)
        for op, wanted in (("add", x + y), ("mul", x * y), ("div", x / y), ("sqrt", np.sqrt(abs(x)))):
            assert ieee_single(op, *((abs(a),) if op == "sqrt" else (a, b))) == wanted
        lost = Fraction(a) + Fraction(b) - Fraction(float(x + y))
        assert ieee_single("two_sum_error", a, b) == lost
        assert ieee_single("two_product_error", a, b) == a * b - float(x * y)
    assert to_single(1e39) == math.inf == -to_single(-1e39)


def test_the_text_is_rewritten_in_code_alone():
    text = (
        "/* double 0.1, sqrt(2.0) */ double a = sqrt(0.1) + 1e-300 + 1e300 + 2.0; "
        'const char *b = "0.1 double";'
    )
    assert in_single(text) == (
        "/* double 0.1, sqrt(2.0) */ float a = sqrtf(0.1f) + 1e-45f + (float)INFINITY + 2.0f; "
        'const char *b = "0.1 double";'
    )


REFUSED = (
    ({"accuracy": "extended"}, {}, "single precision has standard alone"),
    ({}, {"to": "jax"}, "is for c: jax is not written in single"),
    ({}, {"to": "numba"}, "is for c: numba is not written in single"),
    ({"motion": {"theta": [0, 1], "omega0": 1, "alpha": 1e39}}, {}, "alpha = 1e[+]39: in single precision"),
    ({"motion": {"theta": [0, 1], "omega0": 1, "alpha": 1e-46}}, {}, "alpha = 1e-46: in single precision"),
    ({}, {"float": 1}, "float"),
)


@pytest.mark.parametrize(("more", "options", "told"), REFUSED)
def test_what_has_no_single_precision_is_refused_by_name(more, options, told, tmp_path):
    place = tmp_path / ("press.py" if options.get("to") == "numba" else "press")
    with pytest.raises((ValueError, TypeError), match=told):
        dx.compile(scene(**more), place, **{"to": "c", "float": True} | options)
    assert not list(tmp_path.iterdir())


def test_a_machine_compiles_with_all_options(tmp_path):
    """Single precision, and an FMU that is driven by a speed."""
    press = dx.Machine(ec=10, AB=40, BC=[100, 120], omega=50, m_slider=0.4, units="mm, deg, rpm")
    place = press.compile(tmp_path / "press", ["T_in"], to="c", float=True)
    assert "press_point(const float in[]" in (place / "press.h").read_text(encoding="utf-8")
    pytest.importorskip("fmpy")
    made = press.compile(tmp_path / "press.fmu", ["T_in"], to="fmu", fmi=2, input="omega")
    with zipfile.ZipFile(made) as archive:
        told = archive.read("modelDescription.xml").decode()
    assert 'fmiVersion="2.0"' in told
    assert 'name="torque"' not in told
