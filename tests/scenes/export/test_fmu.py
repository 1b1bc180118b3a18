"""FMUs: what fmpy says of them, their motion beside `simulate`, partial derivatives, messages, events."""

import ctypes
import itertools
import math
import random
import zipfile
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.force_truth import truth
from tests.compiler.languages.tools import CPLUSPLUS, STRICT, run, tool
from tests.effort import cases, first

fmpy = pytest.importorskip("fmpy")

LENGTHS = {"ec": 0.01, "AB": 0.04, "BC": 0.1}
MASSES = {"m_slider": 0.4, "m_rod": 0.2, "I_crank": 2e-3}
LOADS = {"F_Y": -20.0, "g_Y": -9.81}
OUTPUTS = ("V_C", "a_C", "T_in", "N_C", "kinetic_energy", "a_C_wrt_ec", "N_C_wrt_AB", "status")


def content(branch=1, **more):
    return {
        "outputs": list(OUTPUTS),
        "mechanism": {**LENGTHS, "branch": branch},
        "motion": {"theta": 0.3, "omega": 5.0},
        "masses": MASSES,
        "loads": LOADS,
        **more,
    }


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Input -> the FMU of the scene above."""
    folder = tmp_path_factory.mktemp("fmu")

    def one(drive):
        place = folder / drive / "press.fmu"
        if not place.exists():
            place.parent.mkdir()
            dx.compile(content(), place, to="fmu", input=drive)
        return str(place)

    return one


def simulated(place, kind, stop, step, output, **start):
    """The results of fmpy's importer."""
    return fmpy.simulate_fmu(
        place, fmi_type=kind, start_values=start, stop_time=stop, output_interval=step, output=output,
        relative_tolerance=1e-10,
    )  # fmt: skip


LOG = []  # the messages of the last instance


@cache
def callbacks():
    """The callbacks of all instances: fmpy has one logger in a process, which lives as long."""
    from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
    from fmpy.logging import addLoggerProxy

    made = fmi2CallbackFunctions()
    made.logger = fmi2CallbackLoggerTYPE(lambda *a: LOG.append(a[-1].decode()))
    addLoggerProxy(ctypes.byref(made))
    return made


class Instance:
    """An instance of an FMU, in initialisation mode; `self.log` has its messages."""

    def __init__(self, place, kind="ModelExchange", start=None):
        from fmpy import extract, fmi2, read_model_description

        self.about = read_model_description(place)
        self.refs = {v.name: v.valueReference for v in self.about.modelVariables}
        self.log, self.kind = LOG, kind
        self.fmu = (fmi2.FMU2Model if kind == "ModelExchange" else fmi2.FMU2Slave)(
            guid=self.about.guid,
            unzipDirectory=extract(place),
            modelIdentifier="press",
            instanceName="one",
        )
        LOG.clear()
        self.fmu.instantiate(callbacks=callbacks())
        self.fmu.setupExperiment(startTime=0.0)
        self.set(**(start or {}))
        self.fmu.enterInitializationMode()

    def set(self, **values):
        self.fmu.setReal([self.refs[name] for name in values], list(values.values()))

    def get(self, *names):
        return list(self.fmu.getReal([self.refs[name] for name in names]))

    def slopes(self, of, by):
        """The partial derivatives: a row for each of the unknowns."""
        call = self.fmu.getDirectionalDerivative
        of, by = [self.refs[name] for name in of], [self.refs[name] for name in by]
        return np.array([call(of, [place], [1.0]) for place in by]).T

    def start(self):
        self.fmu.exitInitializationMode()
        if self.kind == "ModelExchange":
            self.fmu.newDiscreteStates()
            self.fmu.enterContinuousTimeMode()
        return self

    def close(self):
        self.fmu.freeInstance()


def validate(place):
    """Schema, names, units, roles, structure; the sources are clean under the flags of embedded projects."""
    from fmpy.validation import validate_fmu

    assert validate_fmu(place) == []
    with zipfile.ZipFile(place) as archive:
        folder = place.removesuffix("press.fmu")
        source = archive.extract("sources/press.c", folder)
    headers = f"{fmpy.__path__[0]}/c-code"
    compilers = ("gcc", STRICT), ("clang", STRICT), ("g++", CPLUSPLUS)
    for compiler, flags in compilers[: cases(1, 3)]:
        run(tool(compiler), *flags, f"-I{headers}", "-fsyntax-only", source)


@pytest.mark.sampled
@pytest.mark.parametrize("drive", ["torque", "omega"])
def test_fmpy_finds_no_problem(drive, made):
    validate(made(drive))


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_the_motion_is_that_of_simulate(kind, made):
    names = ["theta", "omega", *OUTPUTS[:5]]
    result = simulated(made("torque"), kind, 0.1, 0.01, [*names, "status"], torque=1.5)
    times = result["time"]
    fixed = {**LENGTHS, **MASSES, **LOADS}
    expected = dx.simulate(
        torque=1.5, t_end=0.1, theta0=0.3, omega_start=5.0, times=times, names=OUTPUTS[:5], **fixed
    )
    for name in names:
        scale = np.abs(expected[name]).max()
        np.testing.assert_allclose(result[name], expected[name], rtol=0, atol=1e-8 * scale, err_msg=name)
    assert (result["status"] == 0).all()


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_given_speed(kind, made):
    """The outputs are those of `evaluate` at the angle that the speed has led to."""
    names = ["theta", *OUTPUTS[:5]]
    result = simulated(made("omega"), kind, 0.5, 0.05, names, omega=7.0, theta0=1.0)
    theta = 1.0 + 7.0 * result["time"]
    np.testing.assert_allclose(result["theta"], theta, rtol=1e-12)
    expected = dx.evaluate(
        OUTPUTS[:5], theta=result["theta"], omega=7.0, alpha=0.0, **LENGTHS, **MASSES, **LOADS
    )
    for name in OUTPUTS[:5]:
        np.testing.assert_allclose(result[name], expected[name], rtol=1e-11, atol=1e-12)


# ---- partial derivatives --------------------------------------------------------------------------

ROWS = ("der(omega)", *OUTPUTS[:7])
AT = {**LENGTHS, "m_crank": 0.0, **MASSES, "I_rod": 0.0, "g_X": 0.0, "g_Y": -9.81, "F_X": 0.0, "F_Y": -20.0}


def exact(name, torque, theta, omega, **given):
    """An output by the raw loop closure and the free bodies: without friction all are affine in alpha."""
    there = {"theta": theta, "omega": omega, **given}

    def parts(name):
        still, more = (truth(name, alpha=alpha, **there) for alpha in (0.0, 1.0))
        return still, more - still

    static, inertia = parts("T_in")
    alpha = (mpmath.mpf(torque) - static) / inertia
    if name == "der(omega)":
        return alpha
    still, by_alpha = parts(name)
    return still + alpha * by_alpha


def difference(name, by, at):
    """The derivative from central differences at 60 digits, extrapolated four times."""
    with mpmath.workdps(60):
        size = 2.0 ** math.floor(math.log2(max(abs(at[by]), 1e-3)))
        steps = [2.0**-k * size for k in (9, 10, 11, 12)]
        ends = [[exact(name, **{**at, by: at[by] + side * h}) for side in (1, -1)] for h in steps]
        result = [(up - down) / (2 * h) for (up, down), h in zip(ends, steps, strict=True)]
        for order in range(1, len(steps)):
            result = [(4**order * b - a) / (4**order - 1) for a, b in itertools.pairwise(result)]
        return float(result[0])


def test_partial_derivatives(made):
    """By states and inputs while time runs, by parameters in initialisation mode."""
    one = Instance(made("torque"), start={"torque": 1.5})
    at = {"torque": 1.5, "theta": 0.3, "omega": 5.0, **AT}
    starts = {"theta0": "theta", "omega_start": "omega"}
    parameters = cases(3, 12)
    knowns = random.Random(36).sample(
        ["BC", "AB", "ec", "m_slider", "m_rod", "I_crank", "I_rod", "g_Y", *starts], parameters
    )
    check(one.slopes(ROWS, knowns), knowns, at, starts)
    one.start()
    check(
        one.slopes(ROWS, ["theta", "omega", "torque", "F_X", "F_Y"]),
        ["theta", "omega", "torque", "F_X", "F_Y"],
        at,
    )
    assert one.slopes(["der(theta)"], ["theta", "omega", "torque"]).tolist() == [[0.0, 1.0, 0.0]]
    one.close()


def check(result, knowns, at, starts=None):
    for row, name in zip(result, ROWS, strict=True):
        for value, by in zip(row, knowns, strict=True):
            expected = difference(name, (starts or {}).get(by, by), at)
            size = max(1e-3, abs(expected))
            assert value == pytest.approx(expected, rel=1e-12, abs=1e-12 * size), (name, by)


# ---- what goes wrong, and what ends ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"AB": -1.0}, "AB = -1: expected a finite length >= 0"),
        ({"BC": 0.0}, "BC = 0: expected a finite length > 0"),
        ({"m_rod": np.nan}, "m_rod = nan: expected a finite mass >= 0"),
        (
            {"BC": 0.02, "theta0": 1.6},
            "theta0 = 1.6: with ec = 0.01, AB = 0.04, BC = 0.02 it cannot be assembled",
        ),
        ({"m_rod": 0.0, "m_slider": 0.0, "I_crank": 0.0}, "without inertia"),
    ],
)
def test_a_bad_parameter_is_an_error_with_a_message(start, message, made):
    one = Instance(made("torque"), start=start)
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        one.fmu.exitInitializationMode()
    assert any(message in line for line in one.log), one.log
    one.close()


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_limit_angle_ends_the_simulation(kind, made):
    """At the instant at which `simulate` meets it."""
    values = {"BC": 0.045, "ec": 0.02, "theta0": 0.0, "omega_start": 8.0, "torque": 1.0}
    given = {**MASSES, **LOADS, "AB": 0.04, "BC": 0.045, "ec": 0.02}
    expected = dx.simulate(torque=1.0, t_end=1.0, theta0=0.0, omega_start=8.0, **given)
    assert expected["status"] == 2
    result = simulated(made("torque"), kind, 1.0, 0.01, ["theta"], **values)
    assert result["time"][-1] == pytest.approx(expected["t"][-1], abs=1e-4)
    assert result["theta"][-1] == pytest.approx(expected["theta"][-1], abs=1e-6)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_friction_holds_the_crank(kind, made):
    values = {"mu": 0.3, "F_X": 30.0, "F_Y": 4.0, "theta0": 1.0, "omega_start": 8.0, "torque": 0.0}
    given = {**LENGTHS, **MASSES, "g_Y": -9.81, "mu": 0.3, "F_X": 30.0, "F_Y": 4.0}
    expected = dx.simulate(torque=0.0, t_end=0.5, theta0=1.0, omega_start=8.0, **given)
    assert expected["status"] == 1
    result = simulated(made("torque"), kind, 0.5, 0.01, ["theta", "omega", "der(omega)"], **values)
    assert result["omega"][-1] == 0.0
    assert result["der(omega)"][-1] == 0.0
    assert result["theta"][-1] == pytest.approx(expected["theta"][-1], abs=1e-6)


SLIDER = {
    "AB": 0.05, "BC": 0.2, "ec": 0.012, "m_slider": 20.0, "m_crank": 1.5, "m_rod": 0.8, "I_crank": 0.02,
    "I_rod": 0.004, "g_X": -9.81, "mu": 0.3,
}  # fmt: skip
RAMPS = {
    "a ramp": (1.0, 0.0, [0.0, 0.5], [0.0, 10.0]),
    "backwards": (2.0, 0.0, [0.0, 0.5], [0.0, -10.0]),
    "steeper": (5.5, 0.0, [0.0, 0.3], [0.0, 20.0]),
    "slower": (4.0, 0.0, [0.0, 0.4], [0.0, 7.3]),
    "to the bound, and the other way": (1.0, 0.0, [0.0, 0.2, 0.6], [0.0, 2.5, -9.0]),
    "after a standstill": (1.0, 4.0, [0.0, 0.1, 0.4], [0.0, 0.0, 9.0]),
    "after a standstill, backwards": (1.0, -4.0, [0.0, 0.1, 0.4], [0.0, 0.0, -9.0]),
}


@pytest.mark.parametrize(("theta", "way"), [(1.0, 1.0), (1.0, -1.0), (2.0, -1.0), (4.0, 1.0)])
def test_an_event_at_the_break_away_is_decided(theta, way, made):
    """At the doubles around an indicator's zero, that of the statics: held below it, or released."""
    start = {**dict.fromkeys(("F_X", "F_Y", "g_Y", "omega_start"), 0.0), **SLIDER, "theta0": theta}
    one = Instance(made("torque"), start=start).start()
    zeros = (ctypes.c_double * one.about.numberOfEventIndicators)()

    def indicator(torque):
        one.set(torque=way * torque)
        one.fmu.getEventIndicators(zeros, len(zeros))
        return min(zeros)

    held, free = 0.0, 20.0
    while held < (middle := 0.5 * (held + free)) < free:
        held, free = (middle, free) if indicator(middle) > 0.0 else (held, middle)
    balance = truth("T_in", theta=theta, omega=0.0, alpha=way * 1e-12, **SLIDER)
    assert way * free == pytest.approx(float(balance), rel=1e-9)
    for torque in (held, free):
        indicator(torque)
        one.fmu.enterEventMode()
        one.fmu.newDiscreteStates()
        one.fmu.enterContinuousTimeMode()
        assert indicator(torque) > 0.0
    assert way * one.get("der(omega)")[0] > 0.0
    one.close()


@pytest.mark.parametrize(
    "name", first(3, dict.fromkeys(["after a standstill, backwards", "steeper", *RAMPS]))
)
def test_friction_lets_go_under_a_rising_torque(name, made, monkeypatch):
    """At the instant at which `simulate` does, from rest and after a standstill."""
    from fmpy.sundials import CVodeSolver

    rates = CVodeSolver.f

    def with_input(solver, t, y, slopes, data):  # fmpy leaves the inputs as at the last step
        solver.input.apply(t)
        return rates(solver, t, y, slopes, data)

    monkeypatch.setattr(CVodeSolver, "f", with_input)
    theta, omega, times, torques = RAMPS[name]
    start = {**dict.fromkeys(("F_X", "F_Y", "g_Y"), 0.0), **SLIDER, "theta0": theta, "omega_start": omega}
    result = fmpy.simulate_fmu(
        made("torque"), fmi_type="ModelExchange", start_values=start, stop_time=times[-1],
        input=np.array(list(zip(times, torques, strict=True)), [("time", float), ("torque", float)]),
        output=["theta", "omega"], relative_tolerance=1e-8,
    )  # fmt: skip
    expected = dx.simulate(
        torque=lambda t: np.interp(t, times, torques), t_end=times[-1], theta0=theta, omega_start=omega,
        times=result["time"], **SLIDER,
    )  # fmt: skip
    assert abs(expected["omega"][-1]) > 1.0
    np.testing.assert_allclose(result["theta"], expected["theta"], rtol=0, atol=1e-5)


def test_states_are_kept_and_set(made):
    one = Instance(made("torque"), "CoSimulation", {"torque": 1.5}).start()
    one.fmu.doStep(0.0, 0.01)
    state = one.fmu.getFMUstate()
    data = one.fmu.serializeFMUstate(state)
    first = [one.get("theta", "omega")]
    for back in (state, one.fmu.deSerializeFMUstate(data)):
        one.fmu.doStep(0.01, 0.02)
        first.append(one.get("theta", "omega", "T_in"))
        one.fmu.setFMUstate(back)
    one.fmu.doStep(0.01, 0.02)
    assert first[1] == first[2] == one.get("theta", "omega", "T_in") != first[0]
    one.close()


def test_instances_in_parallel(made):
    """Each with parameters of its own: the same as one after the other."""
    masses = np.linspace(0.1, 2.0, 8)
    place = made("torque")  # once, ahead of the threads

    def last(mass):
        one = Instance(place, "CoSimulation", {"torque": 1.5, "m_slider": mass}).start()
        for k in range(50):
            one.fmu.doStep(0.002 * k, 0.002)
        result = one.get("theta", "omega")
        one.close()
        return result

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(last, masses))
    assert together == [last(mass) for mass in masses]


REFUSED = (
    ({"masses": {}}, {}, "nothing moves under a torque without inertia"),
    ({"accuracy": "extended"}, {}, "an FMU has standard"),
    (
        {"outputs": ["V_C_wrt_omega0"], "motion": {"theta": 0.3, "omega0": 5.0}},
        {},
        "an FMU has a given state",
    ),
    ({}, {"input": "speed"}, "input = 'speed': it is torque or omega"),
)


@pytest.mark.parametrize(("more", "options", "message"), REFUSED)
def test_what_an_fmu_cannot_carry_is_refused_by_name(more, options, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        dx.compile(content(**more), tmp_path / "press.fmu", to="fmu", **options)
    assert not list(tmp_path.iterdir())


def test_without_a_compiler_an_fmu_has_its_sources(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.warns(UserWarning, match="no C compiler found"):
        place = dx.compile(content(), tmp_path / "press.fmu", to="fmu")
    with zipfile.ZipFile(place) as archive:
        names = archive.namelist()
    assert names == ["modelDescription.xml", "sources/press.c"]


DRIVER = """
#include "press.c"
static double drawn(unsigned long *seed) {
  *seed = *seed * 6364136223846793005UL + 1442695040888963407UL;
  return (double)(*seed >> 11) / 9007199254740992.0;
}
int main(void) {
  unsigned long seed = 36;
  int good = 0;
  for (int k = 0; k < 1000; k++) {
    const int steps = k % 2;
    const fmi2CallbackFunctions calls = {NULL, calloc, free, NULL, NULL};
    const fmi2Type type = steps ? fmi2CoSimulation : fmi2ModelExchange;
    fmi2Component one = fmi2Instantiate("a", type, TOKEN, "", &calls, 0, 0);
    fmi2ValueReference places[N_VALUES];
    double values[N_VALUES], seeds[N_VALUES], found[N_VALUES], z[N_EVENTS], states[2];
    for (unsigned j = 0; j < N_VALUES; j++) {
      places[j] = j;
      values[j] = START[j] * 3.0 * drawn(&seed) + (drawn(&seed) < 0.1 ? drawn(&seed) - 0.5 : 0.0);
      values[j] = drawn(&seed) < 0.01 ? (double)NAN : values[j];
      seeds[j] = drawn(&seed);
    }
    fmi2SetReal(one, &places[1], N_PARAMETERS + N_INPUTS, &values[1]);
    fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0);
    fmi2EnterInitializationMode(one);
    fmi2GetReal(one, places, N_VALUES, found);
    fmi2GetDirectionalDerivative(one, places, N_VALUES, &places[1], N_PARAMETERS + N_INPUTS, seeds, found);
    if (fmi2ExitInitializationMode(one) == fmi2OK) {
      good++;
      for (int step = 0; steps && step < 5; step++) {
        if (fmi2DoStep(one, 0.01 * step, 0.01, 0) != fmi2OK) {
          break;
        }
      }
      if (!steps) {
        fmi2EnterContinuousTimeMode(one);
        fmi2GetContinuousStates(one, states, 2);
        fmi2GetDerivatives(one, states, 2);
        fmi2GetEventIndicators(one, z, N_EVENTS);
      }
      fmi2GetReal(one, places, N_VALUES, found);
      const fmi2ValueReference knowns[] = {THETA, OMEGA, FIRST_INPUT};
      fmi2GetDirectionalDerivative(one, places, N_VALUES, knowns, 3, seeds, found);
      fmi2FMUstate state = NULL;
      fmi2GetFMUstate(one, &state);
      fmi2SetFMUstate(one, state);
      fmi2FreeFMUstate(one, &state);
    }
    fmi2Reset(one);
    fmi2FreeInstance(one);
  }
  printf("%d", good);
  return 0;
}
"""


def started(place, folder):
    """Count the random presses of a thousand that start, under sanitizers that find nothing."""
    with zipfile.ZipFile(place) as archive:
        (folder / "press.c").write_bytes(archive.read("sources/press.c"))
    (folder / "main.c").write_text(DRIVER, encoding="utf-8")
    checks = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O1")
    headers = f"-I{fmpy.__path__[0]}/c-code"
    run(tool("gcc"), "-std=c99", *checks, headers, folder / "main.c", "-o", folder / "main", "-lm")
    return int(run(folder / "main"))


@pytest.mark.thorough
def test_sanitizers_find_nothing_in_a_thousand_random_presses(made, tmp_path):
    """Parameters of which some are bad: what can start moves, what cannot is refused."""
    assert 200 < started(made("torque"), tmp_path) < 1000
