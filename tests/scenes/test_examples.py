"""The examples about forces, run as they stand."""

import contextlib
import runpy
from pathlib import Path

import numpy as np
import pytest

import desaxe as dx
from tests.effort import first

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def feeder(tmp_path_factory):
    """The scene of paper B, run in a folder of its own: that folder and the result."""
    folder = tmp_path_factory.mktemp("feeder")
    with contextlib.chdir(folder):
        return folder, dx.scene(EXAMPLES / "feeder.toml").run()


def test_feeder_against_what_paper_b_prints(feeder):
    verdicts = [(result.check.source, result.agrees) for result in feeder[1].checks]
    right = [("paper B", True)] * 2 + [("existing model", True)] * 2
    assert verdicts == right + [("this model", False)] * 2


@pytest.mark.thorough
def test_feeder_has_the_torque_of_its_mechanism(feeder):
    """Over a turn at constant speed the drive does no work; the peaks are those of a fine sweep."""
    torque = feeder[1].dataset.T_in
    assert np.abs(torque.values[:, :-1].mean(axis=1)).max() < 1e-9 * float(np.abs(torque).max())
    result = feeder[1].peaks[0].dataset
    design = {"AB": 0.04, "BC": 0.064, "omega0": 80 * np.pi}
    masses = {"m_rod": 0.5, "m_slider": 0.8, "I_rod": 0.5 * 0.064**2 / 12}
    for ec in (0.0, 0.01, 0.02):
        fine = dx.evaluate("T_in", theta=np.linspace(0, 2 * np.pi, 20_001), ec=ec, **design, **masses)
        assert float(result.value.sel(ec=ec)) == pytest.approx(np.abs(fine).max(), rel=1e-6)
    step = 1e-6
    heavier, lighter = (
        dx.peak("T_in", ec=0.02, **design, **{**masses, "m_slider": 0.8 + d})["value"] for d in (step, -step)
    )
    slope = float(result.value_wrt_m_slider.sel(ec=0.02))
    assert slope == pytest.approx((heavier - lighter) / (2 * step), rel=1e-6)


def test_feeder_writes_its_files(feeder):
    folder, result = feeder
    names = ["feeder.nc", "feeder_acceleration.png", "feeder_slider.png", "feeder_torque.png"]
    assert sorted(path.name for path in (folder / "out").iterdir()) == names
    assert sorted(path.name for path in result.files) == names
    text = str(result)
    assert max(map(len, text.splitlines())) <= 100
    assert text.isascii()


@pytest.mark.parametrize(("paper", "low", "high"), first(1, [("a", 9, 12), ("b", 5, 18), ("c", 5, 11)]))
def test_figures_of_the_papers(paper, low, high, tmp_path, capsys):
    script = runpy.run_path(str(EXAMPLES / f"paper_{paper}.py"))
    script["main"](str(tmp_path / "new"))
    lines = capsys.readouterr().out.splitlines()
    names = [f"paper_{paper}_{number:02}.png" for number in range(low, high + 1)]
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == names
    assert [Path(line.partition(" - ")[0]).name for line in lines] == names


def test_figures_of_paper_b_say_which_offset():
    draw = runpy.run_path(str(EXAMPLES / "paper_b.py"))["draw"]
    for number in range(5, 15):
        assert draw(number).get_title(loc="left").endswith(", e = 20 mm")
    assert draw(16).get_legend().get_title().get_text() == "ec [m]"
    assert draw(17).get_title(loc="left").endswith("e = 0 mm")
