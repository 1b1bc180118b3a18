"""Loads in compiled modules: in every language the values are those of `evaluate` of the same scene."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.languages import languages
from desaxe.compiler.languages.python import compile_python
from desaxe.compiler.passes.trigonometry import expand_trigonometry
from desaxe.compiler.program import tables_in
from desaxe.mechanism.constants import constants
from desaxe.scenes.export.portable import Order, module_of
from tests.compiler.languages.runners import compiled
from tests.compiler.languages.tools import imported, jax_in_doubles
from tests.effort import cases
from tests.loads.module_loads import FIXED, INPUTS, KINDS, NAMES, SHAPES, columns, load, scene

DEFAULT = {
    ("c", "inner both ways"), ("c", "theta"), ("c", "outer"), ("c", "sum"),
    ("octave", "Y"), ("octave", "inner both ways"),
    ("javascript", "theta"), ("javascript", "outer both ways"),
}  # fmt: skip


def tried():
    """Every language and kind, of which DESAXE_THOROUGH=all runs all."""
    every = [(one.name, kind) for one in languages() for kind in KINDS]
    return [
        pytest.param(*row, marks=pytest.mark.sampled if row in DEFAULT else pytest.mark.thorough)
        for row in every
        if row in DEFAULT or cases(0, row == ("jax", "inner both ways"), 1)
    ]


def compare(result, given, load):
    """The values are those of `evaluate`, to what an ulp of an angle is worth."""
    right = dx.evaluate(NAMES, **given, **FIXED, F_Y=load)
    for name in NAMES:
        own, truth = result[name], np.asarray(right[name], float)
        np.testing.assert_array_equal(np.isnan(own), np.isnan(truth), name)
        size = np.nanmedian(np.abs(truth))
        near = np.isnan(truth) | (np.abs(own - truth) <= 2e-11 * (np.abs(truth) + size))
        assert near.all(), (name, [c[~near][:3] for c in given.values()], own[~near][:3], truth[~near][:3])


@pytest.mark.parametrize(("language", "kind"), tried())
def test_every_language_has_the_values_of_evaluate(language, kind, tmp_path):
    one = load(kind, SHAPES[len(kind) % 3])
    given = columns(one, cases(100, 2_000, 10_000))
    compare(compiled(language, tmp_path, scene(one), INPUTS)([*given.values()]), given, one)


@pytest.mark.sampled
@pytest.mark.parametrize("kind", ["theta", pytest.param("outer both ways", marks=pytest.mark.thorough)])
def test_c_has_the_digits_of_its_program_in_python(kind, tmp_path):
    """Every operation is rounded as plain Python rounds it, and in the same order."""
    one = load(kind, "smooth")
    given = columns(one, cases(100, 1_000))
    rows = [*given.values()]
    frozen = compiled("c", tmp_path, scene(one), INPUTS)(rows)
    module = module_of(dx.scene(scene(one)), Order("c", "press", ""))
    own = module.forms
    stable, plain, test = (
        compile_python(expand_trigonometry(p, constants())) for p in (own.stable, own.plain, own.test)
    )
    arrays = [*one.arrays()]
    assert tables_in(own.stable) == ["F_Y"]
    for number, point in enumerate(zip(*given.values(), strict=True)):
        row = dict(zip(INPUTS, map(float, point), strict=True))
        if not abs(row["theta"]) <= constants().limit:
            continue  # those angles are the C library's
        wide = test(*(row[name] for name in own.test.inputs))[0]
        chosen, inputs = (plain, own.plain.inputs) if wide else (stable, own.stable.inputs)
        expected = [float(x) for x in chosen(*(row[n] for n in inputs), *arrays)[: len(NAMES)]]
        np.testing.assert_array_equal([frozen[name][number] for name in NAMES], expected)


@pytest.mark.sampled
def test_a_table_over_theta_has_the_digits_of_the_kernels(tmp_path):
    """What is looked up by an angle alone is the same number in machine code of numba and of C."""
    dx.define("push", "1.0 * F_Y", "N")
    try:
        one = load("theta", "smooth")
        given = columns(one, cases(2_000, 10_000))
        written = scene(one, outputs=["push", "push_wrt_theta", "T_in"])
        result = compiled("c", tmp_path, written, INPUTS)([*given.values()])
        right = dx.evaluate(["push", "push_wrt_theta"], **given, **FIXED, F_Y=one)
        good = (np.abs(given["theta"]) < 9.0) & np.isfinite(given["ec"])  # whole periods are exact
        for name in right:
            np.testing.assert_array_equal(result[name][good], right[name][good])
    finally:
        dx.undefine("push")


@pytest.mark.thorough
def test_jax_has_total_derivatives(tmp_path):
    one = load("outer both ways", "jumping")
    with jax_in_doubles():
        import jax

        module = imported(dx.compile(scene(one, outputs=["T_in"]), tmp_path / "press_jax.py", to="jax"))
        point = (5.8, 0.01, 0.04, 3.0)
        given = dict(zip(INPUTS, point, strict=True))
        result = jax.grad(module.T_in, argnums=(0, 1, 2, 3))(*point)
        for name, own in zip(INPUTS, result, strict=True):
            right = dx.evaluate(f"T_in_wrt_{name}", **given, **FIXED, F_Y=one)
            assert float(own) == pytest.approx(right, rel=1e-12)
        with pytest.raises(NotImplementedError, match="no derived derivative with respect to AB"):
            jax.grad(jax.grad(module.T_in, argnums=2), argnums=2)(*point)


@pytest.mark.thorough
def test_numba_has_points_functions_and_a_reduced_grid(tmp_path):
    one, names = load("outer both ways", "jumping"), ["T_in"]
    written = scene(one, reduce={"theta": "absmax"}, outputs=names)
    module = imported(dx.compile(written, tmp_path / "press_kernels.py"))
    given = [*columns(one, 60).values()]
    result = module.evaluate(*given)
    for k in range(44, 60):
        point = [float(column[k]) for column in given]
        own = module.T_in(*point)
        assert own == pytest.approx(result["T_in"][k], rel=1e-11, abs=1e-11, nan_ok=True)
        np.testing.assert_allclose(module.point(*point)[0], result["T_in"][k], rtol=1e-11, atol=1e-11)
    axes = np.ix_([0.0, 0.01], [0.03, 0.04], [1.0, 2.0], [0.0, 1.0, 2.0])
    grid = dx.evaluate(
        "T_in", **dict(zip(("ec", "AB", "omega0", "theta"), axes, strict=True)), **FIXED, F_Y=one
    )
    own = module.run()
    np.testing.assert_allclose(own["T_in_absmax"], np.abs(grid).max(axis=-1), rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(own["T_in_absmax_theta"], np.abs(grid).argmax(axis=-1))


def test_extended_is_in_c_too(tmp_path):
    one, names = load("outer both ways", "jumping"), ["T_in", "T_in_wrt_AB"]
    rows = [np.linspace(-6.0, 6.0, 9), np.linspace(-0.01, 0.01, 9), np.full(9, 0.04), np.full(9, 3.0)]
    written = scene(one, accuracy="extended", outputs=names)
    result = compiled("c", tmp_path, written, INPUTS)(rows)
    for k, point in enumerate(zip(*rows, strict=True)):
        here = {n: float(x) for n, x in zip(INPUTS, point, strict=True)}
        right = dx.evaluate(names, **here, **FIXED, F_Y=one, accuracy="extended")
        np.testing.assert_allclose([result[n][k] for n in names], [*right.values()], rtol=1e-12, atol=1e-12)


def test_a_scene_without_open_inputs(tmp_path):
    """A load over the stroke gives it a status of its own, which was folded to a number that is none."""
    one, point = load("outer both ways", "kinked"), {"theta": 1.0, "omega0": 2.0}
    lengths = {"ec": 0.01, "AB": 0.04, "BC": 0.064}
    written = {"outputs": ["T_in"], "mechanism": lengths, "motion": point, "loads": {"F_Y": one}}
    module = imported(dx.compile(written, tmp_path / "press_fixed.py"))
    assert module.run() == {
        "T_in": pytest.approx(dx.evaluate("T_in", **lengths, **point, F_Y=one)),
        "status": 0,
    }
