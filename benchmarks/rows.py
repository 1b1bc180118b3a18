"""Works beside others in this process: `python -m benchmarks --only peaks`; a row is a function here.

    @row
    def peaks() -> Ways:
        \"\"\"Largest |a_C| of 8,192 designs.\"\"\"
        return {"desaxe": Way(call, 8192), "NumPy, 720 angles": Way(other, 8192)}

Ways take turns, and the processor's time of the best round counts, for each of `count` designs. They return
the same values: the table has the largest relative difference from the first way, and the ratio of times.
"""

import random
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

import desaxe as dx

from .work import ANGLES, BY_KEY, OMEGA0, Array, Inputs

PATIENCE = 2.0  # seconds that a way may take in all rounds


class Way(NamedTuple):
    """A way to do a work: a call that returns the values which all ways share, and how many it is for."""

    run: Callable[[], Any]
    count: int = 1


Ways = Mapping[str, Way]
ROWS: dict[str, Callable[[], Ways]] = {}


def row(work: Callable[[], Ways]) -> Callable[[], Ways]:
    """Register a function as a row, by its name; the first line of its docstring is the title."""
    ROWS[work.__name__.replace("_", "-")] = work
    return work


def table(name: str, rounds: int) -> str:
    """The table of a row: what each way takes."""
    work = ROWS[name]
    ways = work()
    values = {title: way.run() for title, way in ways.items()}  # compiles, and does not count
    seconds = _least(ways, rounds)
    first = next(iter(ways))
    lines = [work.__doc__ or name, "", "| | us for each | ratio | difference |", "|---|---|---|---|"]
    for title, spent in seconds.items():
        off = _difference(values[title], values[first])
        lines.append(f"| {title} | {spent * 1e6:.4g} | {spent / seconds[first]:.3g} | {off} |")
    return "\n".join(lines)


def _least(ways: Ways, rounds: int) -> dict[str, float]:
    """The least processor time of each way for each of its designs; the order changes from round to round."""
    least, spent, order = dict.fromkeys(ways, inf), dict.fromkeys(ways, 0.0), [*ways]
    for number in range(rounds):
        random.Random(number).shuffle(order)
        for title in order:
            if number and spent[title] > PATIENCE:
                continue
            start = time.process_time()
            ways[title].run()
            once = time.process_time() - start
            spent[title] += once
            least[title] = min(least[title], once / ways[title].count)
    return least


def _difference(values: Any, first: Any) -> str:
    """The largest difference from the values of the first way, relative to the largest of these."""
    if values is None or first is None:
        return ""
    one, other = np.ravel(values), np.ravel(first)
    size = min(one.size, other.size)
    return f"{np.max(np.abs(one[:size] - other[:size])) / np.max(np.abs(other[:size])):.1e}"


# ---- peaks -----------------------------------------------------------------------------------------

DESIGNS = 8_192


@row
def peaks() -> Ways:
    """Largest |a_C| of 8,192 designs, refined, beside the textbook formula at 720 angles."""
    rng = np.random.default_rng(0)
    ranges = {"ec": (0.0, 0.1), "AB": (0.1, 0.13), "BC": (0.3, 0.4)}
    designs = {name: rng.uniform(*ends, DESIGNS) for name, ends in ranges.items()}
    ours = partial(dx.peak, "a_C", **designs, omega0=OMEGA0)
    return {
        "dx.peak": Way(lambda: np.abs(ours(threads=1)["value"]), DESIGNS),
        **{f"NumPy, {n} designs at a time": Way(_dense(designs, n), DESIGNS) for n in (16, 64, DESIGNS)},
    }


@row
def few_peaks() -> Ways:
    """Peaks of one design, of 200 and of 200 with friction: values differ, and are not compared."""
    ec = np.linspace(0.0, 0.1, 200)
    one = partial(dx.peak, "a_C", ec=0.05, AB=0.1, BC=0.35, omega0=30.0)
    many = partial(dx.peak, "T_in", ec=ec, F_Y=-100.0, threads=1, **LOADED)
    return {
        "one": Way(lambda: one() and None),
        "200 of T_in": Way(lambda: many() and None, ec.size),
        "200 of T_in with friction": Way(lambda: many(mu=0.1) and None, ec.size),
    }


def _dense(designs: Mapping[str, Array], block: int) -> Callable[[], Array]:
    """The dense grid, some designs at a time: what fits in the caches is best."""
    from .formulas import lambdified  # which needs SymPy

    columns = {"theta": np.linspace(0.0, 2.0 * pi, ANGLES), **designs}
    function = lambdified(("a_C",), Inputs(columns, dict.fromkeys(columns, 0), {"omega0": OMEGA0}), "numpy")

    def run() -> Array:
        largest = np.empty(DESIGNS)
        for start in range(0, DESIGNS, block):
            part = [column[start : start + block, None] for column in designs.values()]
            (values,) = function(columns["theta"], *part)
            largest[start : start + block] = np.abs(values).max(axis=1)
        return largest

    return run


# ---- motions ---------------------------------------------------------------------------------------

MOTIONS, FEW, BATCH, T_END = 200, 10, 4, 1.0
WRT = ("m_slider", "AB", "theta0", "omega_start", "torque")
PARAMETERS = ("AB", "BC", "ec", "m_crank", "m_rod", "m_slider", "I_crank", "I_rod")


def cranks(seed: int = 1) -> dict[str, Any]:
    """Cranks at rest that make some six turns in a second."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.04, 0.06, MOTIONS)
    return {
        "AB": AB, "BC": AB * rng.uniform(2.5, 4.0, MOTIONS), "ec": 0.01, "m_crank": 0.5, "I_crank": 1.4e-2,
        "m_rod": rng.uniform(0.2, 0.5, MOTIONS), "I_rod": 5e-4, "m_slider": rng.uniform(0.5, 2.0, MOTIONS),
    }  # fmt: skip


@row
def motions() -> Ways:
    """The angle after 1 s under 1.5 N m, of many cranks: one call, one by one, SciPy and heyoka."""
    designs = cranks()
    run = partial(dx.simulate, torque=1.5, t_end=T_END, times=[T_END], threads=1)
    by_scipy = _by_scipy()
    each = [{n: float(np.broadcast_to(v, MOTIONS)[k]) for n, v in designs.items()} for k in range(FEW)]
    return {
        "simulate, rtol=1e-10, in one call": Way(lambda: run(**designs)["theta"][:, 0], MOTIONS),
        "rtol=1e-6": Way(lambda: run(rtol=1e-6, **designs)["theta"][:, 0], MOTIONS),
        "rtol=1e-12": Way(lambda: run(rtol=1e-12, **designs)["theta"][:, 0], MOTIONS),
        "one by one": Way(lambda: [float(run(**one)["theta"][0]) for one in each], FEW),
        "solve_ivp, DOP853, rtol=1e-10": Way(lambda: [by_scipy(one) for one in each], FEW),
        **(_by_heyoka(designs) if find_spec("heyoka") else {}),
    }


CRANK = {"AB": 0.04, "BC": 0.064, "ec": 0.01, "m_rod": 0.5, "m_slider": 0.8, "I_crank": 0.01}


def _angle(count: int = 0, **call: Any) -> Way:
    """Simulate a crank, or many equal ones: the angle at the end."""
    many = {**CRANK, "m_slider": np.full(count, CRANK["m_slider"])} if count else CRANK
    run = partial(dx.simulate, threads=1, **{"t_end": T_END, **call, **many})
    return Way(lambda: np.ravel(run()["theta"])[-1], count or 1)


@row
def motors() -> Ways:
    """The angle after 1 s on a motor, as a table and as a function."""
    table = dx.over_omega([0.0, 400.0], [3.0, -5.0], kind="linear")

    def function(t: float, theta: float, omega: float) -> float:
        """Give the torque of the motor at a speed."""
        return 3.0 - 0.02 * omega

    return {
        "over_omega": _angle(torque=table),
        "four designs": _angle(4, torque=table),
        "a Python function": _angle(torque=function),
        "200 designs, compiled": _angle(200, torque=function),
    }


@row
def stiff_motors() -> Ways:
    """The angle after 0.1 s on a stiff induction motor (kloss)."""
    kloss = dx.kloss("40 N m", 0.15, "1500 rpm", gear=12)
    return {"alone": _angle(torque=kloss, t_end=0.1), "four designs": _angle(4, torque=kloss, t_end=0.1)}


@row
def rubbing() -> Ways:
    """The angle after 1 s under a constant torque with guide friction."""
    return {"alone": _angle(torque=2.0, mu=0.1), "four designs": _angle(4, torque=2.0, mu=0.1)}


@row
def derivatives() -> Ways:
    """Derivatives of whole motions with respect to five parameters, beside the motions alone."""
    run = partial(dx.simulate, torque=1.5, t_end=T_END, times=[T_END], threads=1, **cranks())
    return {
        "simulate": Way(lambda: run()["theta"][:, 0], MOTIONS),
        f"wrt={', '.join(WRT)}": Way(lambda: run(wrt=WRT)["theta"][:, 0], MOTIONS),
    }


def _inertia(of: Any, theta: Any, machine: Mapping[str, Any]) -> Any:
    """The effective inertia, written with the sines of a module."""
    AB, BC, ec, m_crank, m_rod, m_slider, I_crank, I_rod = (machine[name] for name in PARAMETERS)
    u = AB * of.sin(theta) + ec
    turn = AB * of.cos(theta) / of.sqrt(BC * BC - u * u)  # dphi/dtheta
    slide = -(AB * of.sin(theta)) - u * turn  # dY/dtheta
    x, y = 0.5 * AB * of.cos(theta), 0.5 * (slide - AB * of.sin(theta))  # of the middle of the rod
    fixed = I_crank + m_crank * AB * AB * 0.25
    return fixed + m_rod * (x * x + y * y) + I_rod * turn * turn + m_slider * slide * slide


def _by_scipy() -> Callable[[dict[str, float]], float]:
    """A function that integrates one motion with SciPy."""
    import sympy as sp
    from scipy.integrate import solve_ivp

    theta, *parameters = symbols = sp.symbols(["theta", *PARAMETERS])
    inertia = _inertia(sp, theta, dict(zip(PARAMETERS, parameters, strict=True)))
    of_theta = sp.lambdify(symbols, [inertia, sp.diff(inertia, theta)], "math", cse=True)

    def run(machine: dict[str, float]) -> float:
        numbers = [machine[name] for name in PARAMETERS]

        def rate(_: float, state: Any) -> list[float]:
            inertia, slope = of_theta(state[0], *numbers)
            return [state[1], (1.5 - 0.5 * slope * state[1] ** 2) / inertia]

        solution = solve_ivp(rate, (0.0, T_END), [0.0, 0.0], method="DOP853", rtol=1e-10, atol=1e-13)
        return float(solution.y[0, -1])

    return run


def _by_heyoka(designs: Mapping[str, Any]) -> dict[str, Way]:
    """heyoka's Taylor series, scalar and in batches."""
    import heyoka as hy

    theta, omega = hy.make_vars("theta", "omega")
    inertia = _inertia(hy, theta, {name: hy.par[k] for k, name in enumerate(PARAMETERS)})
    system = [(theta, omega), (omega, (1.5 - 0.5 * hy.diff(inertia, theta) * omega * omega) / inertia)]
    values = np.array([np.broadcast_to(designs[name], MOTIONS) for name in PARAMETERS])
    alone = hy.taylor_adaptive(system, [0.0, 0.0], tol=1e-12, pars=[0.0] * len(values))
    batch = hy.taylor_adaptive_batch(
        system, np.zeros((2, BATCH)), tol=1e-12, pars=np.zeros((len(values), BATCH))
    )

    def scalar() -> list[float]:
        ends = []
        for k in range(MOTIONS):
            alone.time = 0.0
            alone.state[:], alone.pars[:] = 0.0, values[:, k]
            alone.propagate_until(T_END)
            ends.append(alone.state[0])
        return ends

    def in_batches() -> Array:
        ends = []
        for k in range(0, MOTIONS, BATCH):
            batch.set_time(0.0)
            batch.state[:], batch.pars[:] = 0.0, values[:, k : k + BATCH]
            batch.propagate_until(T_END)
            ends.append(batch.state[0].copy())
        return np.concatenate(ends)

    return {"heyoka, tol=1e-12": Way(scalar, MOTIONS), "heyoka, batch of 4": Way(in_batches, MOTIONS)}


# ---- steady states ---------------------------------------------------------------------------------

PRESSES, TURNS, AGREES = 1000, 400, 1e-11


@row
def steady() -> Ways:
    """The mean speed of presses on an induction motor, beside simulating until two turns agree."""
    rng = np.random.default_rng(1)
    ranges = {
        "AB": (0.04, 0.06),
        "BC": (0.18, 0.25),
        "m_slider": (10.0, 30.0),
        "flywheel_inertia": (1.0, 9.0),
    }
    columns = {name: rng.uniform(*ends, PRESSES) for name, ends in ranges.items()}
    forces = ([0.0, 0.5e-3, 5e-3, 6e-3], [0.0, -9e3, -20e3, 0.0], [0.0] * 4)
    shared = {
        "ec": 0.01, "I_crank": 2.0, "m_rod": 3.0, "I_rod": 0.01, "g_Y": -9.81,
        "F_Y": dx.over_stroke(*forces, dead_centre="outer"), "torque": dx.kloss(40.0, 0.15, 157.08, gear=12),
    }  # fmt: skip
    each = [{**shared, **{name: float(column[k]) for name, column in columns.items()}} for k in range(5)]
    return {
        "dx.steady, 1,000 designs in a call": Way(
            lambda: dx.steady(**shared, **columns)["omega_mean"], PRESSES
        ),
        "one by one": Way(lambda: [dx.steady(**one)["omega_mean"] for one in each], len(each)),
        "simulate until two turns agree": Way(lambda: [_settled(one) for one in each], len(each)),
    }


def _settled(machine: dict[str, Any]) -> float:
    """The mean speed of the first turn that ends as it began."""
    rest = dict(machine)
    rest["I_crank"] += rest.pop("flywheel_inertia")
    speed = 10.0
    for _ in range(TURNS):
        turn = dx.simulate(t_end=5.0, until=2.0 * pi, omega_start=speed, rtol=1e-12, **rest)
        before, speed = speed, float(turn["omega"][-1])
        if abs(speed - before) <= AGREES * speed:
            return 2.0 * pi / float(turn["t_last"])
    raise RuntimeError(f"no periodic motion in {TURNS} turns")


# ---- loads -----------------------------------------------------------------------------------------

LOADED = {"AB": 0.1, "BC": 0.35, "omega0": 30.0, "m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.01}


def _loads() -> dict[str, Any]:
    """A number, and loads of every kind."""
    turn = np.linspace(0.0, 2.0 * pi, 73)[:-1]
    out, back = [0.0, -100.0, -400.0], [0.0, -10.0, -50.0]
    return {
        "a number": -300.0,
        "over theta, 9 points": dx.over_theta(turn[::8], 100.0 * np.sin(turn[::8]) - 50.0, kind="linear"),
        "over theta, 72 points, cubic": dx.over_theta(turn, -100.0 * np.cos(turn)),
        "over Y, 3 points": dx.over_Y([0.27, 0.33, 0.40], out, kind="linear"),
        "over Y, step, both ways": dx.over_Y([0.27, 0.33, 0.40], out, back, kind="step"),
        "over the stroke": dx.over_stroke([0.0, 0.008, 0.1], out[::-1], kind="linear", dead_centre="inner"),
    }


def _under_loads(call: Callable[[Any], Any]) -> Ways:
    """A call under each load; values differ, and are not compared."""
    return {name: Way(lambda load=load: call(load) and None) for name, load in _loads().items()}


@row
def loaded_arrays() -> Ways:
    """T_in at 100,000 random angles, under a number and loads that vary."""
    inputs = {"theta": np.random.default_rng(1).uniform(0.0, 2.0 * pi, 100_000), "ec": 0.01, **LOADED}
    return _under_loads(lambda load: dx.evaluate(["T_in"], F_Y=load, threads=1, **inputs).keys())


@row
def loaded_angles() -> Ways:
    """T_in at 721 angles, under a number and loads that vary."""
    inputs = {"theta": np.linspace(0.0, 2.0 * pi, 721), "ec": 0.01, **LOADED}
    return _under_loads(lambda load: dx.evaluate(["T_in"], F_Y=load, **inputs).keys())


@row
def loaded_grid() -> Ways:
    """T_in at 721 angles of 512 designs as a grid, under a number and loads that vary."""
    axes = {"theta": np.linspace(0.0, 2.0 * pi, 721), "ec": np.linspace(-0.05, 0.05, 512)}
    return _under_loads(lambda load: dx.grid("T_in", F_Y=load, threads=1, **axes, **LOADED).sizes)


@row
def loaded_peaks() -> Ways:
    """Peaks of T_in of 512 designs, under a number and loads that vary."""
    ec = np.linspace(-0.05, 0.05, 512)
    return _under_loads(lambda load: dx.peak("T_in", ec=ec, F_Y=load, threads=1, **LOADED).keys())


@row
def loaded_tolerance() -> Ways:
    """Tolerance of the peak of T_in, three lengths, 2,000 samples, under loads."""
    lengths = {"ec": (0.01, 0.001), "AB": (0.1, 5e-4), "BC": (0.35, 1e-3)}
    scatter = {name: dx.plus_minus(*one) for name, one in lengths.items()}
    rest = {name: value for name, value in LOADED.items() if name not in lengths}
    peak = ("absmax", "T_in")
    return _under_loads(lambda load: dx.tolerance(peak, samples=2_000, F_Y=load, **scatter, **rest).keys())


# ---- the modules of generated/ ---------------------------------------------------------------------

MASSES = {"m_crank": 1.0, "m_rod": 1.0, "m_slider": 2.0, "I_crank": 0.01, "I_rod": 0.01, "mu": 0.1}


def _generated(group: str, is_grid: bool) -> Ways:
    """A module beside the library, each with memory for its answer."""
    module = import_module(f"desaxe.generated.{group}")
    more = MASSES if group == "forces" else {}
    if is_grid:
        shape: tuple[int, ...] = (721, 400)
        axes = {"theta": np.linspace(0.0, 2.0 * pi, 721), "ec": np.linspace(0.0, 0.05, 400)}
        inputs: dict[str, Any] = {**axes, "AB": 0.125, "BC": 0.35, "omega0": OMEGA0}
    else:
        points = BY_KEY["point"].inputs(100_000)
        shape, inputs = points.shape, {**points.broadcast(), **points.scalars}
    outs = [{name: np.empty(shape, kind) for name, kind in module.OUTPUTS.items()} for _ in range(2)]
    theirs = module.grid if is_grid else module.evaluate
    ours: Any = partial(dx.grid if is_grid else dx.evaluate, [*module.OUTPUTS], threads=1)

    def run(call: Any, out: dict[str, Array]) -> Array:
        call(**inputs, **more, out=out)
        return np.nan_to_num(next(iter(out.values())))

    return {"library": Way(partial(run, ours, outs[0])), "module": Way(partial(run, theirs, outs[1]))}


def _register_generated() -> Iterator[None]:
    for group in ("motion", "sensitivities", "forces"):
        for is_grid in (False, True):
            ROWS[f"generated-{group}-{'grid' if is_grid else 'points'}"] = work = partial(
                _generated, group, is_grid
            )
            work.__doc__ = f"desaxe.generated.{group}, {'a grid' if is_grid else '100,000 points'}."
            yield


[*_register_generated()]
