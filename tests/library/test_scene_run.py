"""Scenes: the numbers, the report and the files that come out."""

import contextlib
import io
import math
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray

import desaxe as dx
from desaxe._scene import run as scene_run
from desaxe._scene.progress import progress_bar
from tests.library.scenes import COMPACTOR, SMALL, changed


@pytest.fixture(scope="module")
def compactor(tmp_path_factory):
    """The example, run in a folder of its own: that folder, the result and the steps it told."""
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
    assert "V_C, a_C over one point" in str(result)


def test_given_state():
    data = {**SMALL, "outputs": ["a_C", "a_C_wrt_omega"], "motion": {"theta": [0, 1], "omega": 3, "alpha": 2}}
    data["peak"] = [{"quantity": "a_C"}]
    result = dx.scene(data).run()
    point = {"theta": 1.0, "ec": 0.05, "AB": 0.125, "BC": 0.35, "omega": 3.0, "alpha": 2.0}
    assert float(result.dataset.a_C_wrt_omega[1, 1]) == pytest.approx(dx.evaluate("a_C_wrt_omega", **point))
    found = result.peaks[0].dataset
    assert found.value_wrt_omega.units == "m/s/rad"
    assert not found.status.any()


def test_large_grid_in_blocks(monkeypatch):
    whole = dx.scene(SMALL).run().dataset
    monkeypatch.setattr(scene_run, "BLOCK", 5)
    steps = []
    parts = dx.scene(SMALL).run(lambda *step: steps.append(step)).dataset
    assert xarray.testing.assert_identical(parts, whole) is None
    assert [step[:2] for step in steps] == [(0, 2), (1, 2), (2, 2)]


def test_progress(compactor):
    _, _, steps = compactor
    done, total, what = zip(*steps, strict=True)
    assert done == tuple(range(len(steps)))
    assert set(total) == {len(steps) - 1}
    assert what[0] == "values"
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
    assert "3 of 7 steps" in sys.stderr.getvalue()
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar() as progress:
        progress(3, 7, "values")
    assert sys.stderr.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress_bar(delay=0.0) as progress:
        assert progress is None


@pytest.mark.parametrize("text", ["29.5 rad/s", "-20.2 m/s", "-7740 rad/s2", "-994 m/s2"])
def test_test_cases_of_paper_a(compactor, text):
    """Printed and computed stand side by side, and agree."""
    line = next(line for line in str(compactor[1]).splitlines() if text in line)
    assert line.count(text) == 2
    assert line.endswith("agrees")


def test_checks(compactor):
    found = {result.check.quantity: result for result in compactor[1].checks}
    assert found["a_C"].computed == pytest.approx(-993.6, abs=0.05)
    assert all(result.agrees for result in found.values())


def test_peaks(compactor):
    absolute, largest, velocity = (found.dataset for found in compactor[1].peaks)
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
    absolute, largest, velocity = (found.claims[0] for found in compactor[1].peaks)
    assert absolute.computed == pytest.approx(9.99, abs=0.005)
    assert largest.computed == pytest.approx(95.38, abs=0.005)
    assert velocity.computed == pytest.approx(33.37, abs=0.005)
    assert (absolute.agrees, largest.agrees, velocity.agrees) == (False, False, True)


def test_two_angles_share_a_peak_at_ec_0(compactor):
    """There is a kink over ec: one angle's derivative is +, the other's -."""
    absolute, largest, velocity = compactor[1].peaks
    assert not absolute.mirrored.any()
    for found in (largest, velocity):
        assert found.mirrored.tolist() == [True, *[False] * 9]
    assert "+-20.55" in str(compactor[1])


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
    found = compactor[1].feasibility
    assert (found.turning, found.designs) == (23, 24)
    assert found.limit == pytest.approx(0.225)
    (bad,) = found.infeasible
    assert bad.design["ec"] == 0.23
    (low, high) = bad.gaps[0]
    assert math.degrees(low) == pytest.approx(73.74, abs=0.005)
    assert math.degrees(high) == pytest.approx(106.26, abs=0.005)
    text = str(compactor[1])
    assert "|ec| < BC - AB = 0.225 m" in text
    assert "ec = 0.23 m cannot be assembled for theta from 73.74 to 106.26 deg" in text


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
    assert words in str(dx.scene({**SMALL, "mechanism": mechanism}).run())


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


def test_data_file_opens_as_a_tree(compactor):
    with xarray.open_datatree(compactor[0] / "out" / "compactor.nc", engine="h5netcdf") as tree:
        assert set(tree.children) == {"peak_absmax_a_C", "peak_max_a_C", "peak_absmax_V_C"}
        assert tree["a_C"].sel(ec=0.03).shape == (721,)


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


def test_infeasible_peaks_are_told():
    peak = {"quantity": "a_C", "over": {"ec": [0.1, 0.23, 9.0]}}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [peak]}).run())
    assert "1 cannot be assembled at any of these angles" in text
    assert "1 reached at a limit angle or change point" in text


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
