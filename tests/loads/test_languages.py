"""Loads in compiled modules: in every language the values are those of `evaluate` of the same scene."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.schema import SceneError
from tests.compiler.languages.tools import array_values, es_module, imported, jax_in_doubles, library, octave
from tests.effort import cases

POSITIONS, OUTWARD, INWARD = [0.03, 0.05, 0.05, 0.09], [-900, -200, -50, -30], [-90, -40, -15, -3]
DISTANCES, CLOSED, OPENED = [0, 0.008, 0.008, 0.02], [-80, -80, -10, 0], [0, 1, 2, 0]
LOADS = {
    "cubic over theta": dx.over_theta([0.5, 1.0, 2.0, 4.0], [0.0, -400.0, -50.0, 20.0]),
    "two turns, jumps": dx.over_theta([0.0, 1.0, 1.0, 9.0], [0.0, 5.0, -90.0, 1.0], "linear", 4 * np.pi),
    "over Y, jumps": dx.over_Y(POSITIONS, OUTWARD, INWARD),
    "over Y, cubic": dx.over_Y([0.02, 0.05, 0.07, 0.1], [-900, -200, -50, -30], kind="cubic"),
    "outer": dx.over_stroke(DISTANCES, CLOSED, OPENED, dead_centre="outer"),
    "inner": dx.over_stroke(DISTANCES, CLOSED, dead_centre="inner"),
}
NAMES = ["T_in", "T_in_wrt_theta", "T_in_wrt_AB", "T_in_wrt_ec", "N_C", "Y", "status"]
INPUTS = ("theta", "ec", "AB", "omega0")
FIXED = {"BC": 0.064, "m_slider": 0.8}


def scene(load, **more):
    return {
        "outputs": NAMES,
        "mechanism": {"ec": [0.0, 0.01], "AB": [0.03, 0.04], "BC": 0.064},
        "motion": {"theta": [0.0, 1.0, 2.0], "omega0": [1.0, 2.0]},
        "masses": {"m_slider": 0.8},
        "loads": {"F_Y": load},
        **more,
    }


def columns(load, count):
    """Designs that turn fully or not, knots of tables over theta, a crank that stands still."""
    random = np.random.default_rng(31)
    theta, ec = random.uniform(-9.0, 9.0, count), random.uniform(-0.03, 0.03, count)
    if load.over == "theta":
        theta[:40] = random.choice(load.table.knots, 40) + load.period * random.integers(-2, 3, 40)
    theta[40:43] = np.nan, np.inf, 1e6
    ec[43] = np.nan
    return [theta, ec, random.uniform(0.03, 0.05, count), random.choice([-3.0, 3.0, 0.0], count)]


def of_c(folder, written, given, libm=True):
    source = dx.compile(written, folder / "press", to="c", libm=libm) / "press.c"
    loaded = library(source, "gcc", ("-O2", "-ffp-contract=off"), libm)
    return dict(zip(NAMES, array_values(loaded, "press", given, len(NAMES)), strict=True))


def of_octave(folder, written, given):
    place = dx.compile(written, folder / "press.m", to="octave")
    return dict(zip(NAMES, octave(place, given, len(NAMES)), strict=True))


def of_jax(folder, written, given):
    with jax_in_doubles():
        module = imported(dx.compile(written, folder / "press_jax.py", to="jax"))
        found = module.evaluate(**dict(zip(INPUTS, given, strict=True)))
        return {name: np.asarray(value) for name, value in found.items()}


def of_javascript(folder, written, given):
    place = dx.compile(written, folder / "press.js", to="javascript")
    lists = {name: column.tolist() for name, column in zip(INPUTS, given, strict=True)}
    return es_module(place, [["evaluate", lists]])[0]  # as JSON, which has no NaN


LANGUAGES = {"c": of_c, "octave": of_octave, "jax": of_jax, "javascript": of_javascript}


TRIED = [(language, kind) for language in LANGUAGES for kind in LOADS if language != "jax" or kind == "inner"]


@pytest.mark.sampled
@pytest.mark.parametrize(("language", "kind"), TRIED)
def test_every_language_has_the_values_of_evaluate(language, kind, tmp_path):
    load = LOADS[kind]
    given = columns(load, cases(300, 10_000))
    if language == "javascript":
        given = [column[44:] for column in given]
    right = dx.evaluate(NAMES, **dict(zip(INPUTS, given, strict=True)), **FIXED, F_Y=load)
    found = LANGUAGES[language](tmp_path, scene(load), given)
    for name in NAMES:
        own, truth = np.asarray(found[name], float), np.asarray(right[name], float)
        np.testing.assert_array_equal(np.isnan(own), np.isnan(truth), name)
        size = np.nanmedian(np.abs(truth))
        near = np.isnan(truth) | (np.abs(own - truth) <= 2e-11 * (np.abs(truth) + size))
        assert near.all(), (name, [c[~near][:3] for c in given], own[~near][:3], truth[~near][:3])


@pytest.mark.thorough
def test_jax_has_total_derivatives(tmp_path):
    load = LOADS["outer"]
    with jax_in_doubles():
        import jax

        module = imported(dx.compile(scene(load, outputs=["T_in"]), tmp_path / "press_jax.py", to="jax"))
        point = (5.8, 0.01, 0.04, 3.0)
        given = dict(zip(INPUTS, point, strict=True))
        found = jax.grad(module.T_in, argnums=(0, 1, 2, 3))(*point)
        for name, own in zip(INPUTS, found, strict=True):
            right = dx.evaluate(f"T_in_wrt_{name}", **given, **FIXED, F_Y=load)
            assert float(own) == pytest.approx(right, rel=1e-12)
        with pytest.raises(NotImplementedError, match="no derived derivative by AB"):
            jax.grad(jax.grad(module.T_in, argnums=2), argnums=2)(*point)


def of_numba(folder, kind):
    """A module of a reduced grid: its grid, arrays, points and scalars."""
    load = LOADS[kind]
    names = ["T_in"]
    written = scene(load, reduce={"theta": "absmax"}, outputs=names)
    module = imported(dx.compile(written, folder / "press_kernels.py"))
    given = columns(load, cases(300, 10_000))
    right = dx.evaluate(names, **dict(zip(INPUTS, given, strict=True)), **FIXED, F_Y=load)
    found = module.evaluate(*given)
    for name in names:
        size = np.nanmedian(np.abs(right[name]))
        np.testing.assert_allclose(found[name], right[name], rtol=2e-11, atol=2e-11 * size)
    for k in range(44, 60):
        point = [float(column[k]) for column in given]
        assert module.T_in(*point) == pytest.approx(found["T_in"][k], rel=1e-11, abs=1e-11, nan_ok=True)
        np.testing.assert_allclose(module.point(*point)[0], found["T_in"][k], rtol=1e-11, atol=1e-11)
    axes = np.ix_([0.0, 0.01], [0.03, 0.04], [1.0, 2.0], [0.0, 1.0, 2.0])
    grid = dx.evaluate(
        "T_in", **dict(zip(("ec", "AB", "omega0", "theta"), axes, strict=True)), **FIXED, F_Y=load
    )
    own = module.run()
    np.testing.assert_allclose(own["T_in_absmax"], np.abs(grid).max(axis=-1), rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(own["T_in_absmax_theta"], np.abs(grid).argmax(axis=-1))


@pytest.mark.thorough
def test_numba_has_the_values_of_evaluate_and_of_a_reduced_grid(tmp_path):
    of_numba(tmp_path, "outer")


def test_extended_is_in_c_too(tmp_path):
    written = scene(LOADS["outer"], accuracy="extended", outputs=["T_in", "T_in_wrt_AB"])
    given = [np.linspace(-6.0, 6.0, 9), np.linspace(-0.01, 0.01, 9), np.full(9, 0.04), np.full(9, 3.0)]
    source = dx.compile(written, tmp_path / "press", to="c") / "press.c"
    found = np.array(array_values(library(source, "gcc", ("-O2",), True), "press", given, 2))
    for k, point in enumerate(zip(*given, strict=True)):
        here = {n: float(x) for n, x in zip(INPUTS, point, strict=True)}
        right = dx.evaluate(["T_in", "T_in_wrt_AB"], **here, **FIXED, F_Y=LOADS["outer"], accuracy="extended")
        np.testing.assert_allclose(found[:, k], list(right.values()), rtol=1e-12, atol=1e-12)


def test_what_a_module_cannot_hold_is_refused_by_name(tmp_path):
    with pytest.raises(SceneError, match=r"loads.F_Y = .*a compiled module holds tables"):
        dx.compile(scene(dx.over_theta(np.sin, np.cos)), tmp_path / "press", to="c")
