"""Cases that fuzzing has found: each gives an error of ours that names the input, or the right value."""

import datetime
import os
from math import inf, isnan, nan
from pathlib import Path

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.cli import main
from desaxe.oracle.truth import truth_all
from desaxe.support.toml import DEEPEST, read_toml
from desaxe.support.written import is_ours

LENGTHS = {"ec": 0.01, "AB": 0.125, "BC": 0.35}
MACHINE = {**LENGTHS, "omega0": 157.08}
HUGE = 10**400
SIMULATED = {**LENGTHS, "I_crank": 0.01, "torque": 1.0, "t_end": 0.01}
TOLERANCES = {"ec": dx.plus_minus(0.02, 1e-4), "AB": 0.04, "BC": 0.064}
TH = np.linspace(0.1, 6.0, 9)
SAMPLES = {"theta": TH, "Y": dx.evaluate("Y", theta=TH, **LENGTHS)}
FUNCTION_INPUTS = {"inputs": ("theta",), **MACHINE}


def peak(**inputs):
    return dx.peak("a_C", **{**MACHINE, **inputs})


def point(**inputs):
    return dx.evaluate("a_C", **{"theta": 1.0, **MACHINE, **inputs})


# What is called, and the words that the error must have.
REFUSED = {
    "angle beyond every double": (lambda: point(theta="1e400deg"), ["theta", "1e400deg"]),
    "range": (lambda: peak(theta=("0 deg", "1e400deg")), ["theta", "1e400deg"]),
    "between": (lambda: dx.enclose("a_C", theta=dx.between(0, "1e400deg"), **MACHINE), ["theta"]),
    "plus_minus": (lambda: dx.enclose("a_C", theta=dx.plus_minus(1, "1e400deg"), **MACHINE), ["theta"]),
    "a time span": (lambda: point(theta=np.timedelta64(1, "s")), ["theta", "timedelta64"]),
    "a date": (lambda: point(theta=datetime.datetime(2020, 1, 1)), ["theta", "datetime"]),
    "branches": (lambda: point(branch=np.array([1, -1])), ["branch", "-1"]),
    "accuracies": (lambda: point(accuracy=["fast"]), ["accuracy", "fast"]),
    "rtol": (lambda: dx.enclose("a_C", theta=1.0, rtol="x", **MACHINE), ["rtol", "'x'"]),
    "boxes": (lambda: dx.enclose("a_C", theta=1.0, boxes="x", **MACHINE), ["boxes", "'x'", "10000000"]),
    "ec of tolerance": (lambda: dx.tolerance("stroke", ec=None, AB=0.1, BC=0.3), ["ec is missing"]),
    "ec of inverse": (lambda: dx.inverse(Y=0.3, ec=None, AB=0.1, BC=0.3), ["ec is missing"]),
    "turns": (lambda: peak(theta=(0, 1e16)), ["theta", "1e+16", "1000"]),
    "samples": (lambda: dx.tolerance("stroke", samples=10**12, **TOLERANCES), ["samples", "100000000"]),
    "alpha of a grid": (lambda: dx.grid("a_C", theta=[1.0], alpha=nan, **MACHINE), ["alpha", "nan"]),
    "alpha of a point": (lambda: point(alpha=nan), ["alpha", "nan"]),
    "a huge stroke": (lambda: dx.synthesize(stroke=HUGE, time_ratio=1.1, BC=0.3), ["stroke", "1.8e308"]),
    "a huge ratio": (lambda: dx.synthesize(stroke=0.1, time_ratio=10**5000, BC=0.3), ["time_ratio"]),
    "complex point": (lambda: point(theta=1 + 1j), ["theta", "1j", "real"]),
    "complex peak": (lambda: peak(ec=1j), ["ec", "1j", "real"]),
    "complex inverse": (lambda: dx.inverse(Y=1j, **LENGTHS), ["Y", "1j", "real"]),
    "no torque": (lambda: dx.simulate(**{**SIMULATED, "torque": []}), ["torque", "empty"]),
    "text torque": (
        lambda: dx.simulate(**{**SIMULATED, "torque": lambda t, theta, omega: "1"}),
        ["torque", "'1'"],
    ),
    "complex torque": (
        lambda: dx.simulate(**{**SIMULATED, "torque": lambda t, theta, omega: np.complex128(1j)}),
        ["torque", "1j"],
    ),
    "NaN torque": (
        lambda: dx.simulate(**{**SIMULATED, "torque": lambda t, theta, omega: nan}),
        ["torque", "nan"],
    ),
    "a huge length": (lambda: dx.Machine(**{**MACHINE, "ec": HUGE}), ["ec", "bits"]),
    "a huge angle": (lambda: dx.Machine(**MACHINE).evaluate("a_C", theta=HUGE), ["theta", "bits"]),
    "a huge period": (lambda: dx.over_theta([0.0, 1.0], [0.0, 1.0], period=HUGE), ["period", "bits"]),
    "a load from nothing": (lambda: dx.over_theta.read(None), ["path", "None"]),
    "bytes as names": (lambda: dx.function("a_C", inputs=b"x", **MACHINE), ["120"]),
    "text as out": (lambda: dx.function("a_C", **FUNCTION_INPUTS)(1.0, out="x"), ["out", "'x'"]),
    "a constant": (lambda: dx.define("zz", "k*a_C", k=np.timedelta64(1, "s")), ["k", "timedelta64"]),
    "nuisance": (lambda: dx.fit(SAMPLES, over={"AB": (0.1, 0.2)}, ec=0.01, BC=0.35, nuisance=b"x"), ["nuis"]),
    "a huge sample": (lambda: dx.fit({"theta": [0.0], "Y": [HUGE]}, over={"AB": (0.1, 0.2)}), ["data", "Y"]),
    "orders": (lambda: dx.harmonics("a_C", orders=HUGE, **MACHINE), ["orders", "bits"]),
    "radius": (lambda: dx.counterweight(radius="x", m_slider=1.0, **MACHINE), ["radius", "'x'"]),
    "memory": (lambda: dx.sweep("a_C", store="x", memory=HUGE, theta=[1.0, 2.0], **MACHINE), ["memory"]),
    "store": (lambda: dx.sweep("a_C", store=1.0, theta=[1.0, 2.0], **MACHINE), ["store", "1.0"]),
    "names of a page": (lambda: dx.explore(path="a.html", names=1.0, **MACHINE), ["names", "1.0"]),
    "an array for a yes or no": (lambda: dx.compile({}, "a.c", to="c", check=np.ones(2)), ["check", "True"]),
    "a tiny fluctuation": (lambda: dx.drive(fluctuation=5e-324, m_slider=1.0, **MACHINE), ["fluctuation"]),
    "a range as a table": (lambda: dx.scene({"reduce": range(0)}), ["reduce"]),
    "a huge form": (lambda: dx.equation("a_C", form=HUGE), ["form", "bits"]),
    "numbers as a language": (
        lambda: dx.compile(
            {"outputs": ["Y"], "mechanism": LENGTHS, "motion": {"theta": 1.0}}, "a.c", to=np.ones(2)
        ),
        ["to = array", "numba"],
    ),
    "a time as memory": (
        lambda: dx.sweep("a_C", store="x", memory=np.timedelta64(1, "s"), theta=[1.0], **MACHINE),
        ["memory"],
    ),
    "a huge name": (lambda: dx.optimize(maximize="stroke", over={HUGE: (0, 1)}, AB=0.1, BC=0.3), ["bits"]),
    "a number as a name": (lambda: dx.optimize(maximize="stroke", over={5: (0, 1)}, AB=0.1, BC=0.3), ["5"]),
    "rows of two lengths": (lambda: peak(omega0=[[1.0], [1.0, 2.0]]), ["omega0", "an array of numbers"]),
    "such rows of a fit": (lambda: dx.fit(SAMPLES, over={"AB": 0.1}, ec=0.0, BC=[[1.0], [1.0, 2.0]]), ["BC"]),
    "rows as unknowns": (lambda: dx.fit(SAMPLES, over=[[1.0], [1.0]], ec=0.0, BC=0.3), ["over"]),
    "a length that is a function": (
        lambda: dx.simulate(**{**SIMULATED, "AB": abs, "ec": [0.0, 0.01]}),
        ["AB", "expected a number"],
    ),
    "a huge bore": (lambda: dx.over_theta([0.0, 2.0, 4.0], [1.0, 2.0, 1.0], bore=1e300), ["over_theta"]),
    "a huge branch": (lambda: dx.scene({"mechanism": {"branch": HUGE}}), ["branch"]),
    "a device": (lambda: dx.scene("/dev/zero"), ["/dev/zero", "device"]),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused_in_words_of_ours(what):
    call, words = REFUSED[what]
    with pytest.raises((ValueError, TypeError)) as caught:
        call()
    assert all(word in str(caught.value) for word in words), str(caught.value)
    assert {"desaxe", "derive"} & set(caught.traceback[-1].path.parts)


@pytest.mark.parametrize("call", [dx.enclose, dx.optimize])
def test_time_limits(call):
    expected = {
        dx.enclose: {"name": "a_C", "theta": dx.between(0, 7), **MACHINE, "ec": dx.between(0, 0.2)},
        dx.optimize: {"maximize": "stroke", "over": {"ec": (0.0, 0.1)}, "AB": 0.125, "BC": 0.35},
    }
    with pytest.raises(TimeoutError, match=rf"{call.__name__}: not done within timeout = 0.001 s"):
        call(**expected[call], timeout=1e-3)
    with pytest.raises(ValueError, match="timeout = -1"):
        call(**expected[call], timeout=-1)


def test_slow_torques_end_with_what_there_is():
    calls = []

    def torque(t, theta, omega):
        calls.append(t)
        if len(calls) > 40:
            while dx.simulate and run_out[0] > 0:
                run_out[0] -= 1
        return 1.0

    run_out = [10**7]
    result = dx.simulate(**{**SIMULATED, "torque": torque, "t_end": 1e9}, timeout=0.2)
    assert result["status"] == 4
    assert "timeout = 0.2" in result["message"]


@pytest.mark.thorough
def test_a_timeout_holds_for_every_one_of_many_motions():
    with pytest.raises(TimeoutError, match=r"timeout = 0.2"):
        dx.simulate(**{**SIMULATED, "ec": [0.0, 0.01], "I_crank": 1e-300}, wrt=["ec"], timeout=0.2)


def test_a_motion_of_many_turns_lists_the_first_dead_centres():
    result = dx.simulate(**SIMULATED | {"omega_start": 1e9, "t_end": 1e-3, "I_crank": 0.1})
    assert result["status"] == 0
    assert result["message"].endswith("events list the first 100000 passages of each dead centre")
    centres = [event.theta for event in result["events"]]
    assert len(centres) == 200_000
    np.testing.assert_allclose(np.diff(centres[::2]), 2 * np.pi, rtol=1e-7)


def test_a_pipe_is_no_scene(tmp_path):
    os.mkfifo(tmp_path / "a.toml")
    with pytest.raises(ValueError, match="this is a pipe"):
        dx.scene(tmp_path / "a.toml")


def test_a_pipe_is_neither_replaced_nor_read(tmp_path, capsys, monkeypatch):
    """Each of these waited for whoever would write into the pipe."""
    monkeypatch.chdir(tmp_path)
    scene = {"outputs": ["Y"], "mechanism": LENGTHS, "motion": {"theta": [0.0, 1.0]}}
    Path("a.toml").write_text("outputs = ['Y']\n[mechanism]\nec = 0\nAB = 1\nBC = 3\n[motion]\ntheta = 1\n")
    Path("a.csv").write_text("theta, Y\n1,3.4\n2,2.4\n")
    for name in ("a.png", "a.c", "a.html", "b.csv"):
        os.mkfifo(name)
    for overwrite in ([], ["--overwrite"]):
        assert main(["fit", "a.csv", "--machine", "a.toml", "over=AB", "-o", "a.png", *overwrite]) == 2
        assert "a.png: this is a pipe" in capsys.readouterr().err
    for call in (
        lambda: dx.compile(scene, "a.c", to="c"),
        lambda: dx.explore(scene, "a.html", overwrite=True),
        lambda: dx.over_theta.read("b.csv"),
        lambda: dx.over_Y.read("b.csv"),
        lambda: dx.fit("b.csv", over={"AB": 0.1}, BC=0.3, ec=0.0),
    ):
        with pytest.raises(ValueError, match="this is a pipe"):
            call()
    assert not is_ours(Path("a.png"))


@pytest.mark.parametrize(
    "text", ["a = " + "[" * 100_000, "a" + ".a" * 100_000 + " = 1", "[a" + ".a" * 60 + "]"]
)
def test_deep_toml(text, tmp_path):
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(ValueError, match=f"deeper than {DEEPEST}"):
        read_toml(tmp_path / "a.toml")


def test_a_peak_where_crank_and_rod_are_as_long_as_the_offset():
    for alpha, value in ((0.0, inf), (-1.0, inf), (-50.0, nan)):  # the last one stalls before it turns
        result = dx.peak("a_C", AB=0.1, BC=0.1, ec=0.1, omega0=10.0, alpha=alpha)
        assert result["status"] == 2
        np.testing.assert_equal(result["value"], value)


# ---- the range of inputs ---------------------------------------------------------------------------

NAMES = ["Y", "V_C", "a_C", "j_C", "omega_BC", "alpha_BC", "V_C_wrt_ec", "a_C_wrt_ec_BC", "margin"]
EXTREME = [
    {"theta": 1.0, "ec": 0.03 * s, "AB": 0.125 * s, "BC": 0.35 * s, "omega0": w, "alpha": a}
    for s, w, a in [
        (1e-58, 157.0, 3.0),
        (1e58, 157.0, 3.0),
        (1.0, 1e60, 1.0),
        (1.0, 1e-60, 1e-60),
        (1e-58, -1e60, 1e60),
    ]
]


@pytest.mark.parametrize("inputs", EXTREME)
@pytest.mark.parametrize("arrays", [False, True], ids=["point", "arrays"])
def test_values_near_the_ends_of_the_range(inputs, arrays):
    given = {n: np.full(3, v) for n, v in inputs.items()} if arrays else inputs
    if arrays:
        given["BC"][1] = 0.35 * 2.0**10  # the others of an array are not disturbed
    result = dx.evaluate([*NAMES, "status"], **given)
    assert np.ravel(result["status"])[0] == 0
    for name, true in truth_all(NAMES, **inputs).items():
        value = float(np.ravel(result[name])[-1])
        with mpmath.workdps(30):
            off = abs(mpmath.mpf(value) - true) if np.isfinite(value) else 0.0
            assert off <= 1e-12 * abs(true) + 1e-323 or value == float(true), name
        if isnan(value) or abs(value) == inf:
            assert value == float(true), name


def test_peaks_near_the_ends_of_the_range():
    near = dx.peak("a_C", ec=0.0, AB=0.125, BC=0.35, omega0=157.08)
    for power in (-190, 190):
        far = dx.peak("a_C", ec=0.0, AB=0.125 * 2.0**power, BC=0.35 * 2.0**power, omega0=157.08)
        assert far["value"] == pytest.approx(near["value"] * 2.0**power, rel=1e-13)
        assert far["gradient"]["AB"] == pytest.approx(near["gradient"]["AB"], rel=1e-9)


LARGE, ROD = "at most 1e[+]60", "a length from 1e-60 to 1e[+]60 m"
BEYOND = [({"omega0": -1.1e60}, LARGE), ({"ec": 1e61}, LARGE), ({"BC": 1e-61}, ROD), ({"BC": 1e200}, ROD)]


@pytest.mark.parametrize(("inputs", "limit"), BEYOND)
def test_inputs_beyond_the_range_are_refused_by_name(inputs, limit):
    design, ((name, value),) = {"ec": 0.0, "AB": 0.125, "BC": 0.35, "omega0": 157.08}, inputs.items()
    for given in (value, np.full(2, value)):
        for call in (lambda **at: dx.evaluate("V_C", theta=1.0, **at), lambda **at: dx.peak("V_C", **at)):
            with pytest.raises(ValueError, match=rf"^{name}.*{limit}"):
                call(**{**design, name: given})
    some = {**design, name: np.array([design[name], value])}
    result = dx.evaluate(["V_C", "status"], theta=1.0, **some)
    over = dx.grid("V_C", theta=[0.5, 1.0], **some)
    top = dx.peak("V_C", **some)
    assert result["status"].tolist() == over.status.values[-1].tolist() == [0, 4]
    assert top["status"][1] == 4
    assert np.isnan([result["V_C"][1], over.V_C.values[-1, 1], top["value"][1]]).all()


LINKS = {"AB": 0.1, "BC": 0.3}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: dx.inverse(Y=0.3, ec=10**400, **LINKS), "ec = .*"),
        (lambda: dx.crossings("a_C", value="x", ec=0.0, omega0=1.0, **LINKS), "value = 'x'"),
        (lambda: dx.solve(over={"ec": (0.0, 0.1)}, stroke=0.2, where=[1.0], **LINKS), "where = .*a dict"),
        (lambda: dx.solve(over={"ec": (0.0, 0.1)}, stroke=0.2, branch=[1j], **LINKS), "branch"),
        (lambda: dx.enclose("Y", theta=1.0, ec=0.0, AB=0.1, BC=(None, 1.0)), "BC"),
    ],
)
def test_bad_values_are_named(call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def test_no_designs_have_no_values():
    assert dx.grid("a_C", theta=[0.0, 1.0], ec=0.0, AB=[], BC=0.3, omega0=1.0).a_C.size == 0
    assert dx.crossings("V_C", ec=0.0, AB=[], BC=0.3, omega0=1.0)["theta"].shape == (0, 0)
    assert dx.crossings("a_C", value=1e300, ec=0.0, omega0=1.0, **LINKS)["count"] == 0
