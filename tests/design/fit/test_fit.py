"""Fits of synthetic measurements: what is recovered, how surely, and what the data leave open."""

import json
import math
import pickle
import random
import re
import traceback

import mpmath
import numpy as np
import pandas
import pytest
import xarray

import desaxe as dx
from desaxe.cli import main
from desaxe.oracle.truth import truth
from tests.effort import cases

MACHINE = {"ec": 0.012, "AB": 0.125, "BC": 0.35}
THETA = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
NOISE = 5.0
TRUE = {**MACHINE, "theta_offset": 0.03, "a_C_bias": 4.0}
CLEAN = dx.evaluate("a_C", theta=THETA + 0.03, omega0=150.0, **MACHINE) + 4.0
OVER = {"ec": 0.0, "AB": (0.1, 0.15), "BC": 0.36}


def measured(seed):
    return {"theta": THETA, "a_C": CLEAN + np.random.default_rng(seed).normal(0.0, NOISE, THETA.size)}


def fitted(data, **options):
    options = {"sigma": {"a_C": NOISE}, "nuisance": ("theta_offset", "a_C_bias"), **options}
    return dx.fit(data, over=OVER, omega0=150.0, **options)


@pytest.mark.sampled
def test_errors_are_as_large_as_they_are_told():
    """Within one standard error in 63 to 73 %, within three in 99 %; the scatter is the covariance."""
    runs = [fitted(measured(seed)) for seed in range(cases(25, 500))]
    off = np.array([[(f["value"][n] - TRUE[n]) / f["std_error"][n] for n in f["names"]] for f in runs])
    slack = 4.0 * np.sqrt(0.68 * 0.32 / len(runs))
    assert np.all(np.abs((np.abs(off) < 1.0).mean(axis=0) - 0.683) < slack)
    assert np.all((np.abs(off) < 3.0).mean(axis=0) >= 0.98)
    assert np.all(np.abs(off.std(axis=0) - 1.0) < 4.0 / np.sqrt(2.0 * len(runs)))


@pytest.mark.parametrize("loss", ["huber", "soft_l1", "cauchy", "arctan"])
def test_a_robust_loss_shrugs_off_outliers(loss):
    data = measured(5)
    data["a_C"][::20] += 2000.0
    for options in ({}, {"sigma": None}):
        result = fitted(data, loss=loss, **options)
        off = [(result["value"][n] - TRUE[n]) / result["std_error"][n] for n in result["names"]]
        assert max(map(abs, off)) < 3.5
    assert abs(fitted(data)["value"]["a_C_bias"] - 4.0) > 50.0


def test_residuals_far_beyond_sigma_are_told():
    """By chi-square where all count; of a robust loss by the scatter of most of them."""
    data = measured(6)
    good = fitted(data)
    assert 0.8 < good["chi_square"] < 1.25
    assert good["message"] == fitted(data, loss="huber")["message"] == "converged"
    assert math.isnan(fitted(data, sigma=None)["chi_square"])
    spoiled = {**data, "a_C": data["a_C"].copy()}
    spoiled["a_C"][::20] += 2000.0
    assert re.search("chi-square is .* try loss='huber'", repr(fitted(spoiled)))
    assert "sigma" not in fitted(spoiled, loss="huber")["message"]
    small = {"a_C": 0.1 * NOISE}
    assert "chi-square" in fitted(data, sigma=small)["message"]
    assert "outliers apart" in fitted(data, sigma=small, loss="huber")["message"]


def test_what_the_data_leave_open_is_named():
    """Speeds of the slider know the products of length and crank speed only."""
    speed = dx.evaluate("V_C", theta=THETA, omega0=150.0, **MACHINE)
    result = dx.fit({"theta": THETA, "V_C": speed}, over={**OVER, "omega0": 140.0}, sigma={"V_C": 0.01})
    (direction,) = result["unidentified"]
    assert direction == pytest.approx({"ec": 1.0, "AB": 1.0, "BC": 1.0, "omega0": -1.0}, abs=1e-6)
    assert result["status"] == 2
    assert all(np.isinf(error) for error in result["std_error"].values())
    assert result["value"]["AB"] * result["value"]["omega0"] == pytest.approx(0.125 * 150.0)


SPEEDS = np.linspace(100.0, 180.0, THETA.size)


def test_a_measured_speed_of_the_crank_is_an_input():
    """Beside the angles, one where it is not known; with a given speed it is measured as any other."""
    omega = SPEEDS.copy()
    data = {"theta": THETA, "V_C": dx.evaluate("V_C", theta=THETA, omega=omega, **MACHINE)}
    over = {"ec": 0.0, "AB": 0.1}
    fixed = dx.fit({**data, "V_C": [math.nan, *data["V_C"][1:]]}, over=over, BC=MACHINE["BC"], omega=omega)
    omega[3] = np.nan
    result = dx.fit({**data, "omega": omega}, over=over, BC=MACHINE["BC"])
    for name in ("ec", "AB"):
        assert result["value"][name] == pytest.approx(MACHINE[name], rel=1e-9)
        assert fixed["value"][name] == pytest.approx(MACHINE[name], rel=1e-9)
    assert np.flatnonzero(np.isnan(result["residuals"]["V_C"])).tolist() == [3]
    with pytest.raises(ValueError, match="sigma: V_C, omega are measured"):
        dx.fit({**data, "omega": omega}, over=OVER, omega0=150.0)
    value, _ = result.predict(theta=[1.0, 2.0], omega=[30.0, 40.0])["V_C"]
    expected = [float(truth("V_C", theta=a, omega=w, branch=1, **MACHINE)) for a, w in ((1, 30), (2, 40))]
    assert value == pytest.approx(expected, rel=1e-9)
    assert result.plot()["V_C"].get_xydata().shape == (THETA.size, 2)
    with pytest.raises(TypeError, match="predict: omega= varied with the samples"):
        result.predict(theta=[1.0, 2.0])


def test_times_beside_the_angles_have_the_speed():
    """A crank of theta = 20 t + 3 t^2, which a spline has exactly, as a logger writes it, to 360 degrees."""
    t = np.linspace(0.0, 1.0, 120)
    theta, omega = 20.0 * t + 3.0 * t * t, 20.0 + 6.0 * t
    free = {"alpha": 6.0, "branch": 1, **MACHINE}
    motion = [{"theta": a, "omega": w} for a, w in zip(theta, omega, strict=True)]
    data = {"theta [deg]": np.degrees(theta) % 360.0, "t [ms]": 1e3 * t}
    over = {"ec": 0.0, "AB": 0.1, "BC": 0.4}
    for q, varied in {"V_C": ["omega"], "a_C": ["omega", "alpha"], "Y": []}.items():
        measured = np.array([float(truth(q, **point, **free)) for point in motion])
        result = dx.fit({**data, q: measured}, over={n: over[n] for n in ("ec", "AB")}, BC=MACHINE["BC"])
        assert result["value"] == pytest.approx({n: MACHINE[n] for n in ("ec", "AB")}, rel=1e-7), q
        value, _ = result.predict(theta=1.0, **dict.fromkeys(varied, 6.0))[q]
        assert value == pytest.approx([float(truth(q, theta=1.0, omega=6.0, **free))], rel=1e-6), q
    again = dx.fit({**data, "Y": measured}, over=over, omega0=3.0)  # of which Y needs neither
    assert again["value"] == pytest.approx(MACHINE, rel=1e-9)
    with pytest.raises(TypeError, match="leave omega0 out of over"):
        dx.fit({**data, "Y": measured}, over={"omega0": 20.0}, **MACHINE)
    data["t [ms]"][5] = data["t [ms]"][4]
    with pytest.raises(ValueError, match=r"data: t: .* times that increase"):
        dx.fit({**data, "a_C": measured}, over=over)


def test_the_jacobian_against_differences_of_the_truth():
    result = fitted(measured(1))
    at, value = 17, result["value"]

    def model(**change):
        x = {**{k: mpmath.mpf(v) for k, v in value.items()}, **change}
        point = {"theta": THETA[at] + x["theta_offset"], "omega0": 150.0, **{n: x[n] for n in MACHINE}}
        return truth("a_C", **{"alpha": 0.0, "branch": 1, **point}) + x["a_C_bias"]

    for name in result["names"]:
        step = 2.0**-20 * max(abs(value[name]), 2.0**-6)
        high, low = value[name] + step, value[name] - step
        slope = (float(model(**{name: high})) - float(model(**{name: low}))) / (high - low)
        assert result["jacobian"]["a_C"][name][at] == pytest.approx(slope, rel=1e-8, abs=1e-4), name


def test_over_the_time_with_two_quantities_and_missing_samples():
    t = np.linspace(0.0, 0.5, 200)
    theta, rng = 20.0 * t + 15.0 * t * t, np.random.default_rng(3)
    data = {
        "t": t,
        "Y": dx.evaluate("Y", theta=theta, **MACHINE) + rng.normal(0.0, 1e-4, 200),
        "a_C": dx.evaluate("a_C", theta=theta, omega0=20.0, alpha=30.0, **MACHINE)
        + rng.normal(0.0, 0.5, 200),
    }
    data["Y"][::3] = np.nan
    over = {"ec": 0.0, "AB": (0.1, 0.2), "BC": (0.3, 0.5), "omega0": 18.0, "alpha": 25.0}
    result = dx.fit(data, over=over, sigma={"Y": "0.1 mm", "a_C": 0.5})
    for name, true in {**MACHINE, "omega0": 20.0, "alpha": 30.0}.items():
        assert abs(result["value"][name] - true) < 4.0 * result["std_error"][name]
    assert np.isnan(result["residuals"]["Y"][::3]).all()
    model, x = result._model, np.array(list(result["value"].values()))
    for k in range(x.size):
        step = np.zeros(x.size)
        step[k] = 1e-6 * abs(x[k])
        slope = (model.residuals(x + step) - model.residuals(x - step)) / (2.0 * step[k])
        column = model.jacobian(x)[:, k]
        assert np.abs(slope - column).max() < 1e-6 * np.abs(column).max()


def test_without_sigma_the_residuals_say_how_sure_it_is():
    with_sigma, without = fitted(measured(2)), fitted(measured(2), sigma=None)
    ratio = without["std_error"]["AB"] / with_sigma["std_error"]["AB"]
    rest = with_sigma["residuals"]["a_C"]
    assert ratio == pytest.approx(np.sqrt(rest @ rest / (THETA.size - 5)) / NOISE, rel=1e-3)


def test_prediction_report_picture_and_pickle(tmp_path):
    result = pickle.loads(pickle.dumps(fitted(measured(1))))
    value, error = result.predict(theta=THETA)["a_C"]
    assert np.abs((value - CLEAN) / error).max() < 5.0
    assert "theta_offset [rad]" in result.report()
    assert repr(result) == result.report()
    picture = result.plot()
    assert picture.save(tmp_path / "fit.png").stat().st_size > 1000
    assert picture["a_C"] in picture.axes[0].lines
    assert [ax.get_ylabel() for ax in picture.axes] == ["a_C [m/s^2]", "measured - fitted [m/s^2]"]


def test_tables_labels_and_files(tmp_path, capsys):
    data = measured(1)
    expected = fitted(data)["value"]
    assert fitted(pandas.DataFrame(data))["value"] == expected
    degrees = ("theta", np.degrees(THETA), {"units": "deg"})
    labelled = xarray.Dataset({"a_C": ("theta", data["a_C"], {"units": "m/s^2"})}, {"theta": degrees})
    assert fitted(labelled)["value"] == pytest.approx(expected, rel=1e-9)
    path = tmp_path / "scope.csv"
    rows = [f"{a!r},7,{b!r}" for a, b in zip(np.degrees(THETA).tolist(), data["a_C"].tolist(), strict=True)]
    path.write_text("\n".join(["Model,TDS", "theta [deg],trigger,a_C (m/s2)", *rows, ",,"]), encoding="utf-8")
    assert fitted(path)["value"] == pytest.approx(expected, rel=1e-9)
    scene = tmp_path / "press.toml"
    scene.write_text(
        'outputs = ["a_C"]\n[mechanism]\nec = 0\nAB = "120 mm"\nBC = 0.36\n'
        "[motion]\ntheta = 1\nomega0 = 150\n",
        encoding="utf-8",
    )
    words = ["over=ec,AB,BC", "sigma.a_C=5", "nuisance=theta_offset", "--machine", str(scene)]
    assert main(["fit", str(path), *words, "--json"]) == 0
    capsys.readouterr()
    scene.write_text(
        'units = "mm"\n' + scene.read_text(encoding="utf-8").replace("0.36", "360"), encoding="utf-8"
    )
    assert main(["fit", str(path), *words]) == 0
    (row,) = [line.split() for line in capsys.readouterr().out.splitlines() if " AB [mm] " in line]
    assert float(row[2]) == pytest.approx(1e3 * expected["AB"], rel=1e-6)


@pytest.mark.sampled
@pytest.mark.parametrize("number", range(cases(20, 1000)))
def test_numbers_of_any_size(number):
    """A fit or an error of ours that names what is out of range; no warning, no error of SciPy."""
    source = random.Random(number)
    sizes = [0.0, 5e-324, 1e-300, 1e-101, 1e-90, 1e-3, 0.1, 0.125, 0.2, 50.0, 1e90, 1e101, 1e200, 1.7e308]

    def size():
        return source.choice([-1, 1]) * source.choice(sizes)

    inputs = {"ec": 0.01, "AB": 0.12, "BC": 0.35, "omega0": 150.0, "m_slider": 1.0}
    q, name = source.choice(["V_C", "a_C", "T_in"]), source.choice(["ec", "AB", "BC", "omega0"])
    data = {"theta": THETA, q: dx.evaluate(q, theta=THETA, **inputs)}
    if source.random() < 0.4:
        data[q][source.randrange(data[q].size)] = size()
    del inputs[name]
    try:
        result = dx.fit(
            data,
            over={name: source.choice([size(), tuple(sorted((size(), size()))), (0.1, 0.2), 0.12])},
            sigma=source.choice([None, {q: abs(size())}]),
            nuisance=source.choice([(), f"{q}_bias", f"{q}_scale"]),
            loss=source.choice(["linear", "soft_l1", "huber", "cauchy", "arctan"]),
            **inputs,
        )
    except ValueError as refused:
        error = refused
    else:
        assert result.report()
        return
    assert "/desaxe/" in traceback.extract_tb(error.__traceback__)[-1].filename, error
    assert any(word in str(error) for word in ("over", "sigma", "data", "fit:", name, q)), error


@pytest.mark.parametrize("odd", ["1_0", "\u0661\u0662", "\uff11"])
def test_what_python_alone_reads_as_a_number_is_no_sample(odd, tmp_path):
    (tmp_path / "data.csv").write_text(f"theta [deg], a_C\n1,2\n2,{odd}\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"data\.csv, line 3, column 2 \(a_C\): .* is not a finite number"):
        fitted(tmp_path / "data.csv")
    for column in (["1", odd, "3"], [b"1", b"2", b"3"], np.array([1.0, odd, 3.0], dtype=object)):
        with pytest.raises(TypeError, match="data: a_C: expected real numbers"):
            fitted({"theta": [1.0, 2.0, 3.0], "a_C": column})


STARTS = {"exact": (0.04, 0.13, 0.01), "far": (0.05, 0.09, 0.0), "long": (0.03, 0.18, 0.02)}


@pytest.mark.parametrize("loss", ["linear", "cauchy"])
@pytest.mark.parametrize("start", STARTS)
def test_a_bias_is_solved_for_at_each_step(start, loss):
    """Whatever the start; the samples are those of the loop closure, shifted."""
    lengths = dict(zip(("AB", "BC", "ec"), (0.04, 0.13, 0.01), strict=True))
    theta = np.radians(np.arange(0.0, 355.0, 6.0))
    Y = 0.04 * np.cos(theta) + np.sqrt(0.13**2 - (0.01 + 0.04 * np.sin(theta)) ** 2)
    over = dict(zip(lengths, STARTS[start], strict=True))
    result = dx.fit({"theta": theta, "Y": Y - 0.17}, over=over, nuisance="Y_bias", loss=loss)
    assert result["status"] == 0
    assert result["value"] == pytest.approx({**lengths, "Y_bias": -0.17}, abs=1e-12)
    speed = dx.evaluate("V_C", theta=theta, omega0=10.0, **lengths)  # of which a scale hides the size
    data = {"theta": theta, "Y": Y, "V_C": 1.5 * speed + 0.2}
    sigma = {"Y": 1e-4, "V_C": 1e-3}
    result = dx.fit(data, over=over, sigma=sigma, nuisance=("V_C_scale", "V_C_bias"), loss=loss, omega0=10.0)
    expected = {**lengths, "V_C_scale": 1.5, "V_C_bias": 0.2}
    assert result["value"] == pytest.approx(expected, abs=1e-9)


def test_converged_only_where_the_gradient_is_small():
    """The best fit of these samples is beyond the limit of assembling: the search ends at a slope."""
    data = {"theta": THETA, "Y": 0.04 * np.cos(THETA) + 0.03 * np.cos(2.0 * THETA)}
    result = dx.fit(data, over={"AB": 0.04, "BC": 0.06}, ec=0.0, nuisance="Y_bias")
    assert (result["status"], result["at_bound"]) == (1, {})
    assert "not converged" in result.report()
    assert re.search(r"ran into a change point: .* at theta = (1\.5|4\.7)", result["message"])
    bounded = dx.fit(data, over={"AB": 0.04, "BC": (0.06, 0.09)}, ec=0.0, nuisance="Y_bias")
    assert (bounded["status"], bounded["at_bound"]) == (0, {"BC": "low"})
    assert bounded["message"] == "converged; BC: held by the lower bound"
    (row,) = (line for line in bounded.report().splitlines() if line.startswith("  BC [m]"))
    assert re.fullmatch(r"  BC \[m\] +0\.06 +held by the lower bound", row)


def test_nuisances_take_starts_and_ranges():
    """Of Y from the loop closure: an offset near half a turn, and a bias that a range keeps from its best."""
    Y = 0.04 * np.cos(THETA + 2.9) + np.sqrt(0.13**2 - (0.01 + 0.04 * np.sin(THETA + 2.9)) ** 2)
    lengths = {"AB": 0.05, "BC": 0.12, "ec": 0.0}
    free = dx.fit({"theta": THETA, "Y": Y}, over=lengths, nuisance={"theta_offset": "166 deg", "Y_bias": 0.1})
    assert free["value"]["theta_offset"] == pytest.approx(2.9, abs=1e-9)
    machine = dx.Machine(units="mm, deg", **{name: 1e3 * value for name, value in lengths.items()})
    ranges = {"theta_offset": (120, 200), "Y_bias": (1, 5)}
    held = machine.fit({"theta": np.degrees(THETA), "Y": 1e3 * Y}, over=[*lengths], nuisance=ranges)
    assert held["at_bound"] == {"Y_bias": "low"} or abs(held["value"]["Y_bias"] - 1.0) < 1e-3
    for wrong in ({"Y_bias": (2.0, 1.0)}, {"theta_offset": math.inf}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            dx.fit({"theta": THETA, "Y": Y}, over=lengths, nuisance=wrong)


SCENE = """outputs = ["T_in"]
[mechanism]
ec = "10 mm"
AB = "50 mm"
BC = "200 mm"
branch = -1
[motion]
theta = 1
omega0 = 10
[masses]
m_slider = 3
[loads]
mu = {mu}
F_Y = {{ over_theta = [[0, 10], [90, -300], [200, 50], [300, 0]], theta = "deg", kind = "linear" }}
"""


def test_a_scene_gives_all_of_its_machine(tmp_path, capsys):
    """The load, the friction and the branch too: samples of a slider of 4 kg."""
    knots = np.radians([0.0, 90.0, 200.0, 300.0])
    load = dx.over_theta(knots, [10.0, -300.0, 50.0, 0.0], kind="linear")
    inputs = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 10.0, "mu": 0.1, "F_Y": load, "branch": -1}
    samples = dx.evaluate("T_in", theta=THETA, m_slider=4.0, **inputs)
    scene, path = tmp_path / "press.toml", tmp_path / "run.csv"
    rows = zip(THETA.tolist(), samples.tolist(), strict=True)
    path.write_text("\n".join(["theta,T_in", *(f"{a!r},{b!r}" for a, b in rows)]), encoding="utf-8")
    scene.write_text(SCENE.format(mu=0.1), encoding="utf-8")
    assert main(["fit", str(path), "over=m_slider", "--machine", str(scene), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (result["status"], result["value"]["m_slider"]) == (0, pytest.approx(4.0, rel=1e-12))
    alone = SCENE.format(mu=0.1).removeprefix('outputs = ["T_in"]\n').replace("theta = 1\n", "")
    scene.write_text(alone, encoding="utf-8")
    assert main(["fit", str(path), "over=m_slider", "--machine", str(scene), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == result
    scene.write_text(SCENE.format(mu=[0.1, 0.2]), encoding="utf-8")
    assert main(["fit", str(path), "over=m_slider", "--machine", str(scene)]) == 2
    assert "mu: 2 values, and a fit is of one machine" in capsys.readouterr().err
