"""A crankshaft as source code: the sums of `desaxe.evaluate`, in every language."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.compiler.languages import language_of
from tests.compiler.languages.runners import RUNNERS, SLOW, caller
from tests.crankshaft.test_sums import CYLINDER, PUMP

ANGLES = np.linspace(0.0, 4.0 * np.pi, 61)
GAS = dx.over_theta(ANGLES, -900.0 * np.sin(ANGLES / 2) ** 4, period="720 deg")
NAMES = (
    "T_in", "F_shaking_X", "C_inertia_Y", "M_shaking", "a_C[1]", "T_in_wrt_AB", "T_in_wrt_phase[1]",
    "F_shaking_X_wrt_bank[0]", "T_in_wrt_I_shaft", "omega", "margin", "status",
)  # fmt: skip
LAW = (*NAMES, "T_in_wrt_theta", "T_in_wrt_omega0", "T_in_wrt_alpha")
LANGUAGES = [pytest.param(n, marks=pytest.mark.thorough) if n in SLOW else n for n in RUNNERS]


@pytest.fixture(scope="module")
def shaft():
    """Two machines in a V, with firing a turn late, gravity, a load table and friction."""
    members = [dx.Machine(**one, g_X=1.5, g_Y=-9.81, F_Y=GAS, mu=0.05) for one in (CYLINDER, PUMP)]
    angles = {"phase": [0.0, 1.6], "bank": [0.2, -1.1], "firing": [0.2, 0.5 + 2 * np.pi]}
    return dx.Crankshaft(members, **angles, position=[-0.3, 0.3], I_shaft=0.02)


def written(name):
    return name.replace("[", "_").replace("]", "")


def check(language, place, shaft, names, columns):
    """Stalled and bad points, too."""
    values = caller(language, place, list(columns), [*map(written, names)])(columns.values())
    for name, expected in shaft.evaluate(list(names), **columns).items():
        scale = np.nanmax(np.abs(expected))
        result = values[written(name)]
        np.testing.assert_allclose(result, expected, rtol=1e-11, atol=1e-12 * scale, err_msg=name)


@pytest.mark.parametrize("language", LANGUAGES)
def test_sums_in_every_language(shaft, language, tmp_path):
    suffix, rng = language_of(language).suffix, np.random.default_rng(5)
    theta, speed, alpha = rng.uniform(-9, 9, 25), rng.uniform(90, 150, 25), rng.uniform(-50, 300, 25)
    theta[3], alpha[3], speed[4] = 9.0, -1e4, np.nan
    law = shaft.compile(tmp_path / f"law{suffix}", LAW, language, alpha=None)
    check(language, law, shaft, LAW, {"theta": theta, "omega0": speed, "alpha": alpha})
    turning = shaft.replace(omega=120.0, alpha=40.0)
    state = turning.compile(tmp_path / f"state{suffix}", (*NAMES, "T_in_wrt_theta"), language)
    check(language, state, turning, (*NAMES, "T_in_wrt_theta"), {"theta": theta})


@pytest.mark.thorough
def test_a_derivative_of_jax_is_the_derived_one(shaft, tmp_path):
    import jax

    from tests.compiler.languages.tools import imported, jax_in_doubles

    with jax_in_doubles():
        module = imported(shaft.compile(tmp_path / "law_jax.py", "T_in", "jax", omega0=120.0))
        slope = float(jax.grad(module.T_in)(0.7))
    assert slope == pytest.approx(shaft.evaluate("T_in_wrt_theta", theta=0.7, omega0=120.0), rel=1e-12)


SCENE = """
outputs = ["T_in", "a_C[1]"]
[crankshaft]
phase = [0, "180 deg"]
[mechanism]
ec = 0
AB = 0.045
BC = 0.15
[masses]
m_slider = 0.4
[motion]
omega0 = 150
"""


def test_a_couple_is_one_in_the_notes(shaft, tmp_path):
    shaft.compile(tmp_path / "couple.c", ["C_inertia_Y", "a_C[1]"], "c")
    text = (tmp_path / "couple.h").read_text()
    assert "C_inertia_Y [N*m]: couple of the inertia forces along Y, about the shaft's middle" in text
    assert "a_C_1 [m/s^2]: acceleration of the slider, slider 1" in text


def test_a_file_from_the_command_line(tmp_path, capsys):
    scene, place = tmp_path / "twin.toml", tmp_path / "twin.js"
    scene.write_text(SCENE)
    assert main(["compile", str(scene), "--to", "javascript", "-o", str(place)]) == 0
    assert main(["compile", str(scene), "--to", "javascript", "-o", str(place), "--check"]) == 0
    assert "fresh" in capsys.readouterr().out
    check("javascript", place, dx.Crankshaft.read(scene), ("T_in", "a_C[1]"), {"theta": np.array([0.4, 2.0])})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"to": "fmu"}, "an FMU is of one slider"),
        ({"outputs": ["a_C"]}, r"each slider's own: a_C\[0\] to a_C\[1\]"),
        ({"AB": [0.04, 0.05]}, "AB: of a crankshaft with one number for each slider"),
        ({"F_Y": dx.over_theta(np.cos)}, "a compiled module holds tables"),
    ],
)
def test_what_cannot_be_compiled_is_named(shaft, options, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        shaft.compile(tmp_path / "made.js", **{"to": "javascript", **options})
