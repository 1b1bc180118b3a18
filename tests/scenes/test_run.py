"""Scenes: the numbers, the report and the files that come out."""

import contextlib
import io
import math
import re
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xarray

import desaxe as dx
from desaxe.scenes.command import run_scene
from desaxe.support.progress import progress_bar
from tests.example_scenes import COMPACTOR, SMALL, changed


@pytest.fixture(scope="module")
def compactor(tmp_path_factory):
    """The example, run in a folder of its own: folder, result, and reported steps."""
    folder = tmp_path_factory.mktemp("compactor")
    steps = []
    with contextlib.chdir(folder):
        result = dx.scene(COMPACTOR).run(lambda *step: steps.append(step))
    return folder, result, steps


# ---- what comes out ------------------------------------------------------------------------------


def test_dataset():
    dataset = dx.scene(SMALL).run().dataset
    assert dict(dataset.sizes) == {"ec": 2, "theta": 5}
    assert set(dataset.data_vars) == {"V_C", "a_C", "status", "margin"}
    assert dataset.attrs["title"] == "small"
    assert dataset.attrs["source"].startswith("desaxe ")
    point = {"theta": math.pi / 2, "ec": 0.05, "AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
    assert float(dataset.a_C.sel(ec=0.05)[1]) == pytest.approx(dx.evaluate("a_C", **point), rel=1e-12)


def test_order_of_axes_is_that_of_the_file():
    data = {"motion": SMALL["motion"], "mechanism": SMALL["mechanism"], "outputs": ["Y"]}
    assert dx.scene(data).run().dataset.Y.dims == ("theta", "ec")


def test_one_point():
    data = {**SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}, "motion": {"theta": 1, "omega0": 2}}
    result = dx.scene(data).run()
    assert result.dataset.a_C.dims == ()
    lines = str(result).splitlines()
    rows = [line.split() for line in lines[lines.index("  V_C, a_C over one point") + 2 :]]
    (value,) = [row[1] for row in rows if row[:1] == ["a_C"]]
    assert float(value) == pytest.approx(float(result.dataset.a_C), rel=1e-5)


def test_given_state():
    data = {**SMALL, "outputs": ["a_C", "a_C_wrt_omega"], "motion": {"theta": [0, 1], "omega": 3, "alpha": 2}}
    data["peak"] = [{"quantity": "a_C"}]
    result = dx.scene(data).run()
    point = {"theta": 1.0, "ec": 0.05, "AB": 0.125, "BC": 0.35, "omega": 3.0, "alpha": 2.0}
    assert float(result.dataset.a_C_wrt_omega[1, 1]) == pytest.approx(dx.evaluate("a_C_wrt_omega", **point))
    found = result.peaks[0].dataset
    assert found.value_wrt_omega.units == "m/s/rad"
    assert not found.status.any()


PRESS = {
    "outputs": ["T_in", "N_C"],
    "mechanism": {"ec": "20 mm", "AB": "40 mm", "BC": "64 mm"},
    "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 9}, "omega0": "2400 rpm"},
    "masses": {"m_rod": "0.5 kg", "m_slider": [0.4, 0.8]},
    "loads": {"F_Y": "-50 N", "mu": [0, 0.1]},
}
PRESSED = {"AB": 0.04, "BC": 0.064, "omega0": 80 * math.pi, "m_rod": 0.5, "F_Y": -50.0}


def test_masses_and_loads_are_axes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    dataset = dx.scene({**PRESS, "results": {"data": "press.nc"}}).run().dataset
    assert dataset.T_in.dims == ("theta", "m_slider", "mu")
    assert (dataset.T_in.units, dataset.m_slider.units, dataset.mu.units) == ("N*m", "kg", "1")
    assert (dataset.F_Y.units, float(dataset.F_Y)) == ("N", -50.0)
    point = {**PRESSED, "theta": math.pi / 2, "ec": 0.02, "m_slider": 0.8, "mu": 0.1}
    assert float(dataset.T_in.sel(m_slider=0.8, mu=0.1)[2]) == pytest.approx(
        dx.evaluate("T_in", **point), rel=1e-12
    )
    with xarray.open_dataset(tmp_path / "press.nc", engine="h5netcdf") as written:
        xarray.testing.assert_equal(written.load(), dataset)
        assert written.T_in.units == "N*m"


def test_masses_and_loads_in_peaks():
    peak = {
        "quantity": "T_in",
        "over": {"m_slider": [0.4, 0.8], "ec": [0, "10 mm"]},
        "baseline": {"ec": 0, "m_slider": 0.4, "mu": 0},
        "sensitivities": ["ec", "m_rod", "F_X", "I_rod", "mu"],
        "claim": [{"at": {"ec": "10 mm", "m_slider": 0.8, "F_Y": 0}, "increase": "99 %"}],
    }
    result = dx.scene({**PRESS, "outputs": [], "peak": [peak], "loads": {"F_Y": "-50 N"}}).run()
    found = result.peaks[0].dataset
    assert found.value.dims == ("m_slider", "ec")
    design = {**PRESSED, "F_X": 0.0, "I_rod": 0.0, "mu": 0.0}
    alone = dx.peak("T_in", ec=0.01, m_slider=0.8, **design)
    assert float(found.value[1, 1]) == pytest.approx(alone["value"], rel=1e-12)
    for name in peak["sensitivities"]:
        slope = float(found[f"value_wrt_{name}"][1, 1])
        assert slope == pytest.approx(alone["gradient"][name], rel=1e-9), name
    assert found.value_wrt_m_rod.units == "m^2/s^2"
    base = dx.peak("T_in", ec=0.0, m_slider=0.4, **design)["value"]
    claimed = dx.peak("T_in", ec=0.01, m_slider=0.8, **{**design, "F_Y": 0.0})["value"]
    assert result.peaks[0].claims[0].computed == pytest.approx(100 * (claimed / base - 1), rel=1e-9)
    line = next(line for line in str(result).splitlines() if "d/d(m_rod)" in line)
    assert line.split()[-5:] == ["d/d(ec)", "d/d(m_rod)", "d/d(F_X)", "d/d(I_rod)", "d/d(mu)"]


def test_what_points_to_the_side_has_either_sign_at_ec_0():
    peak = {"quantity": "T_in", "over": {"ec": [0, 0.01]}, "sensitivities": ["ec", "g_X", "m_rod", "F_X"]}
    masses = {"m_rod": 0.5, "m_slider": 0.8}
    result = dx.scene({**PRESS, "outputs": [], "masses": masses, "loads": {}, "peak": [peak]}).run()
    assert result.peaks[0].mirrored.tolist() == [True, False]
    row = next(line for line in str(result).splitlines() if line.split()[:1] == ["0"]).split()
    assert [cell.startswith("+-") for cell in row[3:]] == [True, True, False, False]
    assert row[-1] == "0"  # F_X turns nothing without friction
    assert "such a slope is + at one and - at the other" in str(result)
    pulled = {**PRESS, "outputs": [], "masses": masses, "loads": {"g_X": 9.81}, "peak": [peak]}
    assert not dx.scene(pulled).run().peaks[0].mirrored.any()


def test_checks_at_masses_and_loads():
    at = {"theta": "90 deg", "m_slider": "0.8 kg", "mu": 1.5}
    checks = [
        {"at": {**at, "mu": 0}, "printed": {"T_in": "-310.97 N m", "m_reciprocating": "1.05 kg"}},
        {"at": at, "printed": {"status": 6}},
        {"at": {**at, "omega0": "-2400 rpm"}, "printed": {"status": 5}},
    ]
    point = {**PRESSED, "theta": math.pi / 2, "ec": 0.02, "m_slider": 0.8}
    result = dx.scene({**PRESS, "outputs": [], "check": checks}).run()
    computed = [check.computed for check in result.checks]
    assert computed == pytest.approx([dx.evaluate("T_in", **point), 1.05, 6, 5])


def test_pictures_of_forces(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    family = {"quantity": "T_in", "file": "torque.png", "family": {"m_slider": [0.4, 0.8]}, "at": {"mu": 0}}
    other = {"quantity": "N_C", "file": "guide.png", "over": "mu", "at": {"theta": 1, "m_slider": 1}}
    dx.scene({**PRESS, "outputs": [], "picture": [family, other]}).run()
    assert {path.name for path in tmp_path.iterdir()} == {"torque.png", "guide.png"}


def test_picture_that_needs_less_than_the_outputs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    picture = {"quantity": "phi", "file": "phi.png", "family": {"ec": [0, 0.05]}}
    result = dx.scene({**SMALL, "outputs": ["phi", "V_C"], "picture": [picture]}).run()
    assert [path.name for path in result.files] == ["phi.png"]


def test_a_peak_of_a_derivative_by_a_speed_that_has_no_effect():
    """V_C_wrt_omega does not depend on omega, but only a given state has it."""
    state = {"omega": [10.0, 20.0], "alpha": 3.0, "theta": [0.0, 1.0]}
    peak = [{"quantity": "V_C_wrt_omega"}]
    scene = {
        "outputs": ["V_C"],
        "mechanism": {"AB": 0.1, "BC": 0.3, "ec": 0.0},
        "motion": state,
        "peak": peak,
    }
    result = dx.scene(scene).run().peaks[0].dataset
    alone = dx.peak("V_C_wrt_omega", AB=0.1, BC=0.3, ec=0.0, omega=10.0, theta=(0.0, 1.0))["value"]
    assert result.value.values.tolist() == [alone, alone]


def test_accuracy_reaches_values_peaks_and_checks():
    check = {"at": {"theta": 1.5, "ec": 0.05}, "printed": {"a_C": 1}}
    data = {**SMALL, "peak": [{"quantity": "a_C"}], "check": [check]}
    standard, extended = (dx.scene({**data, "accuracy": word}).run() for word in ("standard", "extended"))
    point = {"AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi, "accuracy": "extended"}
    assert extended.checks[0].computed == dx.evaluate("a_C", theta=1.5, ec=0.05, **point)
    theta = extended.dataset.theta.values
    for k, ec in enumerate((0.0, 0.05)):
        np.testing.assert_array_equal(
            extended.dataset.a_C[k], dx.evaluate("a_C", theta=theta, ec=ec, **point)
        )
        assert float(extended.peaks[0].dataset.value[k]) == dx.peak("a_C", ec=ec, **point)["value"]
        there = float(extended.peaks[0].dataset.theta[k])
        assert float(extended.peaks[0].dataset.value[k]) == abs(
            dx.evaluate("a_C", theta=np.array([there]), ec=ec, **point)[0]
        )
    assert standard.checks[0].computed == pytest.approx(extended.checks[0].computed, rel=1e-13)


def test_large_grid_in_blocks(monkeypatch):
    whole = dx.scene(SMALL).run().dataset
    monkeypatch.setattr("desaxe.scenes.parts.grid.BLOCK", 5)
    steps = []
    parts = dx.scene(SMALL).run(lambda *step: steps.append(step)).dataset
    assert xarray.testing.assert_identical(parts, whole) is None
    assert [step[:2] for step in steps] == [(0, 2), (1, 2), (2, 2)]


def test_progress(compactor):
    _, _, steps = compactor
    done, total, what = zip(*steps, strict=True)
    assert done == tuple(range(len(steps)))
    assert set(total) == {len(steps) - 1}
    assert "values" in what
    assert what[-1] == ""


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_bar(monkeypatch):
    """It shows up on a terminal after a while, and is silent elsewhere."""
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar(delay=0.0) as progress:
        progress(3, 7, "values")
        time.sleep(0.5)
    bar = sys.stderr.getvalue()
    assert re.search(r"3 of 7 steps \|#+ +\| values\r", bar)
    assert bar.endswith("\r\x1b[K")
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar() as progress:
        progress(3, 7, "values")
    assert sys.stderr.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress_bar(delay=0.0) as progress:
        assert progress is None


@pytest.mark.parametrize(
    ("place", "call", "shown"),
    [
        (
            "desaxe.support.deadline",
            lambda: dx.optimize(maximize="time_ratio", over={"ec": (0.0, 0.1)}, AB=0.1, BC=0.3),
            "optimize, 1 evaluations",
        ),
        (
            "desaxe.design.tolerance.tolerance",
            lambda: dx.tolerance("stroke", ec="10 mm ± 1 mm", AB=0.1, BC=0.3),
            "10000 samples",
        ),
    ],
)
def test_long_works_show_progress(monkeypatch, place, call, shown):
    message, expected = [], repr(call())

    @contextmanager
    def bar(**options):
        yield lambda done, total, what: message.append((done, total, what))

    monkeypatch.setattr(f"{place}.progress_bar", bar)
    assert repr(call()) == expected
    assert shown in {what for _, _, what in message}
    assert all(0 <= done < total for done, total, _ in message)


def test_a_scene_that_is_run_in_python_shows_its_progress(monkeypatch):
    message = []

    @contextmanager
    def bar():
        yield lambda done, total, what: message.append(what)

    monkeypatch.setattr("desaxe.scenes.scene.progress_bar", bar)
    dx.Machine(ec=0.0, AB=0.1, BC=0.3).scene("Y", theta=[0.0, 1.0]).run()
    assert message == ["values", ""]


def test_a_run_says_that_it_reads_computes_and_writes(monkeypatch, tmp_path):
    steps = []

    @contextmanager
    def bar():
        yield lambda *step: steps.append(step)

    monkeypatch.setattr("desaxe.scenes.command.progress_bar", bar)
    source, page = dx.Machine(ec=0.0, AB=0.1, BC=0.3).to_scene(tmp_path / "a.toml", "Y"), tmp_path / "a.html"
    assert run_scene(str(source), False, str(page)) == 0
    assert steps[0] == (0, 1, f"reading {source}")
    assert [what for *_, what in steps[1:]][-2:] == ["writing a.html", ""]
    assert [done for done, *_ in steps[1:]] == [*range(steps[1][1] + 1)]


@pytest.mark.parametrize("text", ["29.5 rad/s", "-20.2 m/s", "-7740 rad/s2", "-994 m/s2"])
def test_test_cases_of_paper_a(compactor, text):
    """Printed and computed stand side by side, and agree."""
    line = next(line for line in str(compactor[1]).splitlines() if text in line)
    assert line.count(text) == 2
    assert line.endswith("agrees")


def test_peaks(compactor):
    absolute, largest, velocity = (result.dataset for result in compactor[1].peaks)
    theta = np.linspace(0, 2 * np.pi, 20001)
    for ec in (0.15, 0.22):
        point = {"theta": theta, "ec": ec, "AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
        swept = dx.evaluate(["V_C", "a_C"], **point)
        assert float(absolute.value.sel(ec=ec)) == pytest.approx(np.abs(swept["a_C"]).max(), rel=1e-6)
        assert float(largest.value.sel(ec=ec)) == pytest.approx(swept["a_C"].max(), rel=1e-6)
        assert float(velocity.value.sel(ec=ec)) == pytest.approx(np.abs(swept["V_C"]).max(), rel=1e-6)
    assert absolute.value_wrt_ec.units == "1/s^2"
    step = 1e-6
    design = {"AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
    near = dx.peak("a_C", ec=np.array([0.15 - step, 0.15 + step]), **design)["value"]
    assert float(absolute.value_wrt_ec.sel(ec=0.15)) == pytest.approx(
        (near[1] - near[0]) / (2 * step), rel=1e-6
    )


def test_claims(compactor):
    absolute, largest, velocity = (result.claims[0] for result in compactor[1].peaks)
    assert absolute.computed == pytest.approx(9.99, abs=0.005)
    assert largest.computed == pytest.approx(95.38, abs=0.005)
    assert velocity.computed == pytest.approx(33.37, abs=0.005)
    assert (absolute.agrees, largest.agrees, velocity.agrees) == (False, False, True)


def test_two_angles_share_a_peak_at_ec_0(compactor):
    """There is a kink over ec: one angle's derivative is +, the other's -."""
    absolute, largest, velocity = compactor[1].peaks
    assert not absolute.mirrored.any()
    for result in (largest, velocity):
        assert result.mirrored.tolist() == [True, *[False] * 9]
    assert "+-20.55" in str(compactor[1])


@pytest.mark.parametrize("AB", [0.04, [0.04, 0.03]])
def test_a_slope_that_vanishes_to_rounding_is_0(AB):
    """By symmetry an acceleration at ec = 0 and a dead centre does not depend on ec."""
    peak = {"quantity": "a_C", "kind": "max", "sensitivities": ["ec"]}
    lengths = {"AB": AB, "BC": 0.16, "ec": 0}
    report = str(dx.scene({"mechanism": lengths, "motion": {"omega0": 94.0}, "peak": [peak]}).run())
    slopes = [line.split()[-1 if isinstance(AB, list) else 1] for line in report.splitlines()
              if line.split()[:1] in (["ec"], ["0.04"])]  # fmt: skip
    assert slopes == ["0"], report


def test_peak_over_two_axes_and_part_of_a_turn():
    peak = {
        "quantity": "V_C",
        "kind": "min",
        "over": {"BC": [0.3, 0.4], "AB": [0.1, 0.11, 0.12]},
        "theta": [0, 1],
    }
    data = {**changed("mechanism.ec", 0.01), "outputs": [], "peak": [peak]}
    result = dx.scene(data).run()
    found = result.peaks[0].dataset
    assert dict(found.sizes) == {"BC": 2, "AB": 3}
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.12, "BC": 0.4, "omega0": 50 * math.pi}
    assert float(found.value[1, 2]) == pytest.approx(dx.evaluate("V_C", **point))
    assert result.dataset is None
    assert "(theta from 0 to 57.2958 deg)" in str(result)


def test_feasibility(compactor):
    result = compactor[1].feasibility
    assert (result.turning, result.designs) == (23, 24)
    assert result.limit == pytest.approx(0.225)
    (bad,) = result.infeasible
    assert bad.design["ec"] == 0.23
    (low, high) = bad.gaps[0]
    assert math.degrees(low) == pytest.approx(73.74, abs=0.005)
    assert math.degrees(high) == pytest.approx(106.26, abs=0.005)
    text = str(compactor[1])
    assert "|ec| < BC - AB = 225 mm" in text
    assert "ec = 230 mm cannot be assembled for theta from 73.74 to 106.26 deg" in text


@pytest.mark.parametrize(
    ("mechanism", "words"),
    [
        ({"ec": 0, "AB": 0.4, "BC": 0.3}, "no ec, since BC <= AB"),
        ({"ec": -0.05, "AB": 0.1, "BC": 0.12}, "theta from 224.43 to 315.57 deg"),
        ({"ec": 1, "AB": 0.1, "BC": 0.3}, "cannot be assembled at any angle"),
        ({"ec": 0, "AB": 0.3, "BC": 0.2}, "theta from 41.81 to 138.19 and 221.81 to 318.19 deg"),
        ({"ec": [0.3, 0.4], "AB": [0.1, 0.2, 0.3], "BC": 0.35}, "and 1 more"),
        ({"ec": 0.01, "AB": 0.1, "BC": 0.3}, "1 of 1 designs of this scene turn fully"),
    ],
)
def test_feasibility_in_words(mechanism, words):
    assert words in " ".join(str(dx.scene({**SMALL, "mechanism": mechanism}).run()).split())


def test_files(compactor):
    folder, result, _ = compactor
    names = ["out/compactor.nc", "out/compactor.png", "out/compactor_infeasible.png"]
    assert [path.as_posix() for path in result.files] == names
    assert sorted(path.name for path in (folder / "out").iterdir()) == sorted(
        Path(name).name for name in names
    )
    text = str(result)
    for name in names:
        assert name in text
        assert (folder / name).stat().st_size > 1000


def test_data_file_holds_everything(compactor):
    folder, result, _ = compactor
    path = folder / "out" / "compactor.nc"
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        xarray.testing.assert_equal(dataset.load(), result.dataset)
        assert dataset.a_C.units == "m/s^2"
        assert dataset.status.flag_meanings.startswith("ok ")
        assert np.isnan(dataset.a_C.sel(ec=0.23)).any()
    for group, found in zip(["absmax_a_C", "max_a_C", "absmax_V_C"], result.peaks, strict=True):
        with xarray.open_dataset(path, engine="h5netcdf", group=f"peak_{group}") as dataset:
            again = dataset.rename({f"peak_{name}": name for name in found.dataset.dims})
            xarray.testing.assert_equal(again.load(), found.dataset)
            assert dataset.attrs["quantity"] == found.peak.quantity


def test_report_fits_a_terminal(compactor):
    lines = str(compactor[1]).splitlines()
    assert max(map(len, lines)) <= 100
    assert not [line for line in lines if line != line.rstrip()]
    assert str(compactor[1]).isascii()


def test_long_table_is_thinned():
    over = {"ec": {"start": 0, "stop": 0.2, "num": 101}}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [{"quantity": "a_C", "over": over}]}).run())
    assert "24 of 101 designs are shown" in text
    assert len(text.splitlines()) < 40


@pytest.mark.parametrize("base", [{"ec": 5.0}, {"ec": 0, "AB": 1e-300}])
def test_changes_from_nothing_and_from_next_to_nothing_leave_the_table_whole(base):
    claim = {"at": {"ec": "50 mm"}, "increase": "33 %", "source": "somebody"}
    peak = {"quantity": "a_C", "over": {"ec": [0, "50 mm"]}, "baseline": base, "claim": [claim]}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [peak]}).run())
    *_, first, second, said = (line for line in text.splitlines() if line.startswith("  "))
    assert "nan %" not in text.lower()
    assert max(map(len, text.splitlines())) <= 110
    changes = [row.split()[3] for row in (first, second)]
    if "AB" not in base:
        assert changes == ["-", "-"]
        assert said.endswith("somebody 33 %, but there is no finite change: DIFFERS")
    else:
        assert all(1e200 < float(change) < math.inf for change in changes)
        assert said.endswith("DIFFERS")


def test_infeasible_peaks_are_told():
    peak = {"quantity": "a_C", "over": {"ec": [0.1, 0.23, 9.0]}}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [peak]}).run())
    assert "1 cannot be assembled at any of these angles" in text
    assert "1 reached at a limit angle or change point" in text


def test_what_friction_does_to_peaks_is_told():
    peak = {"quantity": "T_in", "over": {"mu": [0, 0.5, 1.5]}}
    text = str(dx.scene({**PRESS, "outputs": [], "masses": {"m_slider": 1}, "peak": [peak]}).run())
    assert "1 jammed by friction at some angles (no balance of forces)" in text
    assert "1 with two balances of forces at some angles (friction)" in text
    assert max(map(len, text.splitlines())) <= 100


def test_peaks_of_what_the_lengths_do_not_change():
    data = {**SMALL, "outputs": [], "peak": [{"quantity": "V_B"}]}
    result = dx.scene(data).run().peaks[0].dataset
    assert result.value.values == pytest.approx([0.125 * 50 * math.pi] * 2)
    assert [name for name in result if name.startswith("value_wrt_")] == ["value_wrt_AB", "value_wrt_omega0"]


def test_files_are_whole_or_not_there(tmp_path, monkeypatch):
    """An interrupted run leaves the old file as it was."""
    monkeypatch.chdir(tmp_path)
    scene = dx.scene({**SMALL, "results": {"data": "values.nc"}})
    scene.run()
    before = Path("values.nc").read_bytes()

    def interrupted(self, *arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(xarray.Dataset, "to_netcdf", interrupted)
    with pytest.raises(KeyboardInterrupt):
        scene.run()
    assert Path("values.nc").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["values.nc"]


# ---- reductions and files of other kinds ----------------------------------------------------------


def test_reduced_outputs():
    reduced = {**SMALL, "reduce": {"theta": ["absmax", "rms"]}, "threads": 2}
    result = dx.scene(reduced).run()
    whole = dx.scene(SMALL).run().dataset
    assert result.dataset.a_C_absmax.dims == ("ec",)
    np.testing.assert_array_equal(result.dataset.a_C_absmax, np.abs(whole.a_C).max("theta"))
    assert result.dataset.attrs["title"] == "small"
    assert "V_C, a_C (absmax, rms over theta) over ec (2)" in str(result)


def test_a_status_cannot_be_reduced():
    with pytest.raises(ValueError, match=r'outputs #2 = "status": with \[reduce\] a status has no largest'):
        dx.scene({**SMALL, "outputs": ["a_C", "status"], "reduce": {"theta": "max"}})


def test_data_in_every_format(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = {**SMALL, "peak": [{"quantity": "a_C"}]}
    for name in ("a.nc", "a.zarr", "a.csv", "a.xlsx", "a.npz"):
        for _ in range(2):  # an earlier file is replaced
            result = dx.scene({**scene, "results": {"data": name}}).run()
        assert result.files[0] == Path(name)
        assert f"{name} " in str(result)
    dataset, peaks = result.dataset, result.peaks[0].dataset
    with xarray.open_zarr(tmp_path / "a.zarr") as written:  # a warning would be an error
        xarray.testing.assert_equal(written.load(), dataset)
    with xarray.open_zarr(tmp_path / "a.zarr", group="peak_absmax_a_C") as written:
        np.testing.assert_array_equal(written.value, peaks.value)
    with np.load(tmp_path / "a.npz") as written:
        np.testing.assert_array_equal(written["a_C"], dataset.a_C)
        np.testing.assert_array_equal(written["peak_absmax_a_C/value"], peaks.value)
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[1] == "ec [m],theta [rad],V_C [m/s],a_C [m/s^2],status,margin [m]"
    rows = np.array([line.split(",") for line in lines[2:]], dtype=float)
    np.testing.assert_array_equal(rows[:, 3], dataset.a_C.values.reshape(-1))
    np.testing.assert_array_equal(rows[:, 0], np.repeat(dataset.ec.values, 5))
    np.testing.assert_array_equal(rows[:, 5], np.repeat(dataset.margin.values, 5))
    assert "\nec [m],value [m/s^2]," in (tmp_path / "a_peak_absmax_a_C.csv").read_text(encoding="utf-8")
    book = openpyxl.load_workbook(tmp_path / "a.xlsx")
    assert book.sheetnames == ["values", "peak_absmax_a_C", "about"]
    head, *rows = book["values"].values
    assert list(head) == lines[1].split(",")
    np.testing.assert_allclose(np.array(rows)[:, 3], dataset.a_C.values.reshape(-1), rtol=1e-15)
    assert next(book["peak_absmax_a_C"].values)[:2] == ("ec [m]", "value [m/s^2]")
    assert not list(tmp_path.glob(".desaxe-*"))


def test_missing_zarr(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(
        ImportError, match=r"results\.data needs zarr: python -m pip install 'desaxe\[zarr\]'"
    ):
        dx.scene({**SMALL, "results": {"data": "a.zarr"}}).run()


def test_no_change_has_no_sign():
    scene = dx.scene({
        "mechanism": {"ec": [0.0, 0.05], "AB": 0.125, "BC": 0.35},
        "motion": {"omega0": 157.08},
        "peak": [{"quantity": "a_C", "kind": kind, "baseline": {"ec": 0.0}} for kind in ("max", "min")],
    })  # fmt: skip
    rows = [line.split() for line in str(scene.run()).splitlines() if line.split()[:1] == ["0"]]
    assert [row[row.index("%") - 1] for row in rows] == ["0.0", "0.0"]
