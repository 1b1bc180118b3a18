"""Tornado diagrams and panels; what every picture keeps to."""

import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import desaxe as dx
from desaxe.plot import panels, tornado

MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
THETA = np.linspace(0, 2 * np.pi, 91)


def ends(bars):
    """Label of each row, from the top, and where its bars end: (input smaller, input larger)."""
    larger, smaller = bars
    names = [text.get_text() for text in larger[0].axes.get_yticklabels()]
    result = [
        (low.get_x() + low.get_width(), high.get_x() + high.get_width())
        for low, high in zip(smaller, larger, strict=True)
    ]
    return list(zip(names, result, strict=True))[::-1]


def test_bars_of_a_peak_are_what_happens_to_it():
    changes = {"ec": "0.5 mm", "AB": 1e-4, "BC": "0.1 mm"}
    bars = tornado(dx.peak("a_C", ec=0.15, **MACHINE), changes, name="a_C")
    design = {"ec": 0.15, **MACHINE}
    steps = {"ec ± 0.5 mm": ("ec", 5e-4), "AB ± 0.0001 m": ("AB", 1e-4), "BC ± 0.1 mm": ("BC", 1e-4)}
    assert {name for name, _ in ends(bars)} == set(steps)
    widths = [abs(high - low) for _, (low, high) in ends(bars)]
    assert widths == sorted(widths, reverse=True)
    for name, (low, high) in ends(bars):
        parameter, step = steps[name]
        for end, sign in ((low, -1), (high, 1)):
            moved = dx.peak("a_C", **{**design, parameter: design[parameter] + sign * step})["value"]
            there = dx.peak("a_C", **design)["value"]
            assert end - there == pytest.approx(moved - there, rel=0.02)
    assert bars[0][0].axes.get_xlabel() == "acceleration of the slider, a_C [m/s$^{2}$]"


def test_bars_of_tolerances():
    values = dx.evaluate(["V_C", "V_C_wrt_ec", "V_C_wrt_BC"], theta=1.0, ec=0.1, **MACHINE)
    pairs = {"ec": dx.plus_minus(0.1, 1e-3), "BC": dx.plus_minus(0.35, 2e-3)}
    rough = dx.tolerance("V_C", theta=1.0, AB=0.125, omega0=157.08, **pairs)
    bars = dict(ends(tornado(rough, {"ec": 1e-3, "BC": -2e-3}, name="V_C")))
    for name, step in (("ec", 1e-3), ("BC", 2e-3)):
        half = step * values[f"V_C_wrt_{name}"]
        assert bars[f"{name} ± {step:g} m"] == pytest.approx((values["V_C"] - half, values["V_C"] + half))


def test_tornado_on_given_axes_and_complaints():
    axes = Figure().add_subplot()
    result = dx.peak("a_C", ec=0.15, **MACHINE)
    assert tornado(result, {"ec": 1e-3}, ax=axes)[0][0].axes is axes
    with pytest.raises(ValueError, match="no slope by mu in this result, there are: ec, AB"):
        tornado(result, {"mu": 0.1})
    with pytest.raises(TypeError, match="expected a dict with value and gradient"):
        tornado(dx.grid("a_C", theta=1.0, ec=0.1, **MACHINE), {"ec": 1e-3})
    with pytest.raises(ValueError, match="of one design: choose it first"):
        tornado(dx.peak("a_C", ec=[0.1, 0.15], **MACHINE), {"ec": 1e-3})
    with pytest.raises(ValueError, match="ec = '1 kg'"):
        tornado(result, {"ec": "1 kg"})


def test_panels():
    grid = dx.grid(["s", "V_C", "a_C"], ec=[0.0, 0.1], theta=THETA, **MACHINE)
    drawn = panels(grid)
    assert list(drawn) == ["s", "V_C", "a_C"]
    axes = [lines[0].axes for lines in drawn.values()]
    assert [a.get_ylabel() for a in axes] == ["s [m]", "V_C [m/s]", "a_C [m/s$^{2}$]"]
    assert [bool(a.get_xlabel()) for a in axes] == [False, False, True]
    assert [a.get_legend() is not None for a in axes] == [True, False, False]
    np.testing.assert_array_equal(drawn["V_C"][1].get_ydata(), grid.V_C.sel(ec=0.1))
    assert axes[0].figure.get_suptitle().startswith("AB\u00a0=\u00a00.125\u00a0m, BC")


def test_panels_on_given_axes_and_complaints():
    grid = dx.grid(["V_C", "a_C"], ec=0.1, theta=THETA, **MACHINE)
    axes = Figure().subplots(2)
    drawn = panels(grid, ["a_C", "V_C"], ax=axes)
    assert drawn["a_C"][0].axes is axes[0]
    with pytest.raises(ValueError, match="nothing in this dataset varies with 'BC'"):
        panels(grid, over="BC")
    with pytest.raises(ValueError, match="no 'Y' in this dataset"):
        panels(grid, ["Y"])


@pytest.mark.thorough
def test_no_picture_touches_the_global_state():
    code = """
import sys, tempfile
import numpy as np
import desaxe as dx
import matplotlib
before = matplotlib.rcParams.copy()
press = dict(AB=0.125, BC=0.35, omega0=1.0)
theta = np.linspace(0, 6, 9)
grid = dx.grid(["a_C", "V_C"], ec=[0, 0.1], theta=theta, **press)
dx.plot.curves(grid, "a_C")
dx.plot.polar(grid, "a_C")
dx.plot.panels(grid)
dx.plot.design_map(grid, "a_C")
dx.plot.tornado(dx.peak("a_C", ec=0.1, **press), {"ec": 1e-3})
dx.plot.mechanism(theta=1, ec=0, AB=0.125, BC=0.35)
with tempfile.TemporaryDirectory() as folder:
    for kind in ("gif", "html"):
        dx.plot.save(dx.plot.animate(grid.isel(ec=0), "a_C", frames=2), f"{folder}/a.{kind}", dpi=30)
print("matplotlib.pyplot" in sys.modules, matplotlib.rcParams.copy() == before)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False True\n"


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("curves", lambda: dx.plot.curves({}, "a_C")),
        ("polar", lambda: dx.plot.polar({}, "a_C")),
        ("design_map", lambda: dx.plot.design_map({}, "a_C")),
        ("tornado", lambda: dx.plot.tornado({}, {})),
        ("mechanism", lambda: dx.plot.mechanism(theta=0, ec=0, AB=1, BC=2)),
        ("animate", lambda: dx.plot.animate({})),
        ("panels", lambda: dx.plot.panels({})),
    ],
)
def test_missing_extra(monkeypatch, name, call):
    for module in ("matplotlib.figure", "matplotlib.animation", "matplotlib"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"plot\.{name} needs matplotlib.*'desaxe\[plot\]'"):
        call()


def test_labels_of_panels_stand_in_one_column():
    grid = dx.grid(["phi", "a_C"], theta=np.linspace(0, 6, 61), ec=0.1, AB=0.125, BC=0.35, omega0=157.08)
    lines = dx.plot.panels(grid)
    figure = lines["phi"][0].figure
    figure.draw_without_rendering()
    left = {round(line[0].axes.yaxis.label.get_window_extent().x1) for line in lines.values()}
    assert len(left) == 1


def test_a_bounded_curve_with_gaps_is_shown_whole():
    """phi reaches pi/2 where the crank is stuck, and is bounded; the acceleration next to it is not."""
    theta = np.linspace(0, 2 * np.pi, 721)
    grid = dx.grid(["phi", "a_C"], theta=theta, ec=[0.0, 0.23], AB=0.125, BC=0.35, omega0=157.08)
    for name, cut in (("phi", False), ("a_C", True)):
        low, high = dx.plot.curves(grid, name)[0].axes.get_ylim()
        values = grid[name].values
        assert (np.nanmax(values) > high or np.nanmin(values) < low) == cut


def test_save_takes_what_a_plot_returns(tmp_path):
    machine = dx.Machine(ec=0.012, AB=0.125, BC=0.35, omega0=157.0, m_slider=0.8)
    plots = machine.plot("a_C"), machine.plot(["Y", "V_C"]), machine.plot.mechanism(1.0)
    for number, shown in enumerate(plots):
        assert dx.plot.save(shown, tmp_path / f"{number}.png").stat().st_size > 1000
    with pytest.raises(TypeError, match="save: int: expected a figure"):
        dx.plot.save(3, tmp_path / "none.png")
    assert not (tmp_path / "none.png").exists()
