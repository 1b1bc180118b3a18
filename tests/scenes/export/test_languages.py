"""Languages other than C at points where formulas lose their digits, and what each has of its own."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.compiler.languages import languages
from desaxe.oracle.truth import truth
from tests.compiler.languages.runners import compiled
from tests.compiler.languages.tools import es_module, imported, jax_in_doubles
from tests.scenes.export.stress import INPUTS, NAMES, broken, columns, rows, scene

REACH = {"standard": math.inf, "extended": 1e3}
FOLDED = {"ec": 0.125, "AB": 0.125, "BC": 0.25}  # exactly a change-point design


@pytest.fixture(scope="module")
def module(tmp_path_factory):
    """The jax module of branch 1."""
    with jax_in_doubles():
        place = tmp_path_factory.mktemp("jax") / "press_jax.py"
        yield imported(dx.compile(scene(1), place, to="jax"))


@pytest.mark.thorough
def test_the_promise_is_kept_by_jax(module):
    """As it stands, and compiled whole."""
    import jax

    given = dict(zip(INPUTS, columns(1), strict=True))
    for evaluate in (module.evaluate, jax.jit(module.evaluate)):
        assert not broken(evaluate(**given), 1)


@pytest.mark.parametrize("accuracy", ["standard", pytest.param("extended", marks=pytest.mark.thorough)])
@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("language", ["octave", "javascript"])
def test_the_promise_is_kept_by_arrays(language, accuracy, branch, tmp_path):
    reach = REACH[accuracy]
    module = compiled(language, tmp_path, scene(branch, accuracy=accuracy), INPUTS)
    assert not broken(module(columns(branch, reach)), branch, reach)


def test_a_function_of_javascript_gives_what_evaluate_does(tmp_path):
    dx.compile(scene(1), tmp_path / "press.js", to="javascript")
    point = {name: float(column[0]) for name, column in zip(INPUTS, columns(1), strict=True)}
    result, a_C = es_module(tmp_path / "press.js", [["evaluate", point], ["a_C", *point.values()]])
    assert a_C == result["a_C"]


def test_the_promise_is_kept_by_scalars_of_numba(tmp_path):
    place = dx.compile(scene(1, outputs=["Y", "a_C"]), tmp_path / "press_scalars.py")
    press = imported(place)
    points = [[row[name] for name in press.INPUTS] for row in rows(1)]
    assert not broken({n: [getattr(press, n)(*point) for point in points] for n in ("Y", "a_C")}, 1)


# ---- derivatives of jax ---------------------------------------------------------------------------


@pytest.mark.parametrize("distance", [1e-9, pytest.param(-1e-6, marks=pytest.mark.thorough)])
def test_gradients_at_the_change_point(module, distance):
    """Where differentiating a formula by machine loses all digits."""
    import jax

    at = {"theta": math.pi / 2 + distance, **FOLDED, "omega0": 10.0, "alpha": 0.5}
    gradient = jax.jit(jax.grad(lambda point: module.a_C(**point)))(at)
    for name, value in gradient.items():
        assert float(value) == pytest.approx(float(truth(f"a_C_wrt_{name}", **at)), rel=1e-12, abs=1e-300)


@pytest.mark.thorough
def test_second_derivatives(module):
    import jax

    at = {"theta": math.pi / 2 + 1e-4, **FOLDED, "omega0": 10.0, "alpha": 0.5}
    result = jax.hessian(lambda point: module.V_C(**point))(at)
    for first, second, name in (("theta", "ec", "theta_ec"), ("BC", "AB", "AB_BC"), ("ec", "ec", "ec_ec")):
        exact = float(truth(f"V_C_wrt_{name}", **at))
        assert float(result[first][second]) == pytest.approx(exact, rel=1e-12)
    with pytest.raises(NotImplementedError, match="a_C_wrt_ec_ec has no derived derivative with"):
        jax.hessian(lambda ec: module.a_C_wrt_ec(1.0, ec, 0.125, 0.25, 10.0, 0.5))(0.1)


@pytest.mark.thorough
def test_transformations(module):
    import jax
    import jax.numpy as jnp

    angles = jnp.linspace(-3.0, 3.0, 50)
    rest = (0.01, 0.125, 0.35, 10.0, 0.5)
    slope = jax.jit(jax.vmap(jax.jacfwd(module.a_C), (0, *(None,) * 5)))(angles, *rest)
    fixed = dict(zip(INPUTS[1:], rest, strict=True))
    expected = dx.evaluate("a_C_wrt_theta", theta=np.array(angles), **fixed)
    np.testing.assert_allclose(slope, expected, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(
        jax.grad(lambda t: module.Y(t, *rest).sum())(angles),
        dx.evaluate("Y_wrt_theta", theta=np.array(angles), **fixed),
        rtol=1e-12,
    )


@pytest.mark.thorough
def test_float32_stays_float32(module):
    rng = np.random.default_rng(2)
    at = {"theta": rng.uniform(0, 6, 500), "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 10.0, "alpha": 0.5}
    single = {name: np.asarray(value, np.float32) for name, value in at.items()}
    result = module.evaluate(**single)
    expected = dx.evaluate(list(NAMES), **{name: np.asarray(value, float) for name, value in single.items()})
    for name in NAMES:
        assert result[name].dtype == np.float32
        scale = np.abs(expected[name]).max()
        np.testing.assert_allclose(result[name], expected[name], rtol=2e-5, atol=4e-6 * scale)


def test_whole_numbers_and_bad_values(module):
    good = {"ec": 0.02, "AB": 0.04, "BC": 0.064, "omega0": 10, "alpha": 0}
    assert float(module.Y(theta=0, **good)) == pytest.approx(dx.evaluate("Y", theta=0.0, **good))
    for change in ({"theta": math.inf}, {"BC": -1.0}, {"AB": math.nan}):
        assert math.isnan(float(module.Y(**{"theta": 1.0, **good, **change})))


@pytest.mark.parametrize("language", [language.name for language in languages()])
def test_people_are_told_of_every_language(language, capsys):
    main(["compile", "--help"])
    page = Path(__file__).resolve().parents[3] / "docs" / "languages.md"
    assert f"| `{language}`" in page.read_text(encoding="utf-8")
    for text in (dx.compile.__doc__, capsys.readouterr().out):
        assert re.search(rf"^ +{language} +\S", text, re.MULTILINE), text


# ---- files ----------------------------------------------------------------------------------------

FILES = {"c": ["press.c", "press.h"], "octave": ["press.m"], "jax": ["press.py"],
         "javascript": ["press.d.ts", "press.js"]}  # fmt: skip


@pytest.mark.parametrize("to", FILES)
def test_files_are_named_made_and_checked(to, tmp_path):
    """A folder, or the file itself; the same bytes each time; told how they were made; nothing half done."""
    content = scene(1, outputs=["a_C"], title='A "press" */ with \\ and """ in its title')
    place = dx.compile(content, tmp_path / "press", to=to)
    assert sorted(file.name for file in place.iterdir()) == FILES[to]
    texts = {file.name: file.read_text(encoding="utf-8") for file in place.iterdir()}
    for text in texts.values():
        assert f'Generated by `desaxe.compile(scene, "press", to="{to}")`; write it again' in text
        assert f"desaxe {dx.__version__}, derivation " in text
        assert str(tmp_path) not in text
    dx.compile(content, place, to=to, check=True)
    called = next(name for name in FILES[to] if not name.endswith((".h", ".d.ts")))
    single = dx.compile(content, tmp_path / "direct" / called, to=to)
    assert sorted(file.name for file in single.parent.iterdir()) == FILES[to]
    (place / called).write_text("", encoding="utf-8")
    with pytest.raises(ValueError, match=rf"not what the scene gives \({called}\)"):
        dx.compile(content, place, to=to, check=True)
    for name in ("2d", "my press", "class"):
        with pytest.raises(ValueError, match=f"'{name}' cannot be the name of a module"):
            dx.compile(content, tmp_path / name, to=to)
        assert not (tmp_path / name).exists()


def test_what_a_language_lacks_is_refused_by_name(tmp_path):
    with pytest.raises(
        ValueError, match="to = 'fortran': it is one of numba, c, jax, octave, javascript, fmu"
    ):
        dx.compile(scene(), tmp_path / "press", to="fortran")
    with pytest.raises(ValueError, match='accuracy = "extended": jax has standard'):
        dx.compile(scene(accuracy="extended"), tmp_path / "press", to="jax")
    assert not list(tmp_path.iterdir())


def test_a_design_that_cannot_be_assembled_in_jax(tmp_path):
    dx.compile(scene(1, outputs=["V_C", "status", "margin"]), tmp_path / "press.py", to="jax")
    with jax_in_doubles():
        press = imported(tmp_path / "press.py")
        result = press.evaluate(**dict(zip(INPUTS, (1.0, 0.02, 0.04, 0.01, 10.0, 0.0), strict=True)))
    assert int(result["status"]) == 1
    assert float(result["margin"]) == pytest.approx(-0.05)


def test_an_own_quantity_is_carried(tmp_path):
    """With its derivatives, in jax and for @njit functions; one without a meaning, too."""
    import jax

    dx.define("roll", "cos(phi)**2 + sin(2*theta)", unit="1")
    try:
        content = {
            "outputs": ["roll"],
            "mechanism": {"ec": [0, 0.02], "AB": 0.04, "BC": 0.064},
            "motion": {"theta": [0.0, 1.0], "omega0": 3},
        }
        at = {"theta": 0.7, "ec": 0.01, "AB": 0.04, "BC": 0.064}
        expected = dx.evaluate(["roll", "roll_wrt_theta"], **at)
        numba = imported(dx.compile(content, tmp_path / "own_numba.py"))
        with jax_in_doubles():
            made = imported(dx.compile(content, tmp_path / "own_jax.py", to="jax"))
            assert float(made.roll(0.7, 0.01)) == pytest.approx(expected["roll"], rel=1e-14)
            assert float(jax.grad(made.roll)(0.7, 0.01)) == pytest.approx(
                expected["roll_wrt_theta"], rel=1e-13
            )
        assert numba.roll(0.7, 0.01) == pytest.approx(expected["roll"], rel=1e-14)
    finally:
        dx.undefine("roll")
