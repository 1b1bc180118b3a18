"""Trials of input: absurd values for every argument of every public call, and for every key of a scene.

A call may answer, or refuse with a ValueError or TypeError that names the input; MemoryError and TimeoutError
are refusals, too. Anything else, a warning included, is a crash, and a minute without an end is a hang: a
first call compiles, perhaps on a busy machine.
"""

import copy
import datetime
import signal
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import numpy as np

import desaxe as dx
from desaxe.compiler.languages import languages
from desaxe.scenes import schema
from tests.reliability.rig import CRASHED, GOOD, HUNG, Trial, Verdict

SECONDS = 60
LENGTHS = {"ec": 0.01, "AB": 0.125, "BC": 0.35}
MACHINE = {**LENGTHS, "omega0": 157.08}
ANGLES = np.linspace(0.1, 6.0, 9)
SAMPLES = {"theta": ANGLES, "Y": dx.evaluate("Y", theta=ANGLES, **LENGTHS)}
SCENE = {"outputs": ["a_C"], "mechanism": LENGTHS, "motion": {"omega0": 157.08, "theta": [0.0, 1.0]}}
ENDS = {"explore": ".html", "to_excel": ".xlsx"}
VALUES: list[Any] = [
    "x",
    "",
    "1e400 mm",
    "1e99999999 mm",
    "1 mm 2",
    "nan",
    "9" * 5000,
    b"1",
    [],
    (),
    {},
    set(),
    np.array([]),
    np.array(["a"]),
    [1, "a"],
    [[1.0], [1.0, 2.0]],
    1j,
    [1j],
    float("nan"),
    float("inf"),
    -1.0,
    0.0,
    5e-324,
    1e-300,
    1e300,
    10**400,
    10**5000,
    -(10**400),
    True,
    object(),
    np.timedelta64(1, "s"),
    np.datetime64("2020"),
    datetime.datetime(2020, 1, 1),
    datetime.timedelta(1),
    lambda x: x,
    np.ones((2, 2), dtype=complex),
    range(0),
    (0.0, 1e16),
    (1.0, 0.0),
    (0.0,),
    ("a", "b"),
    (None, 1.0),
    (float("nan"), 1.0),
    10**12,
    "=1+1",
    "../x",
    "\x00",
]


class Call(NamedTuple):
    """A public call that is right, and the inputs of it that are exchanged."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    inputs: dict[str, Any]
    also: tuple[str, ...] = ()  # inputs that are not given in the right call


@cache
def calls() -> dict[str, Call]:
    return {
        "evaluate": Call(
            dx.evaluate, ("a_C",), {"theta": 1.0, **MACHINE}, ("branch", "accuracy", "alpha", "m_rod")
        ),
        "evaluate arrays": Call(
            dx.evaluate, ("a_C",), {"theta": [0.0, 1.0], **MACHINE}, ("out", "threads", "branch")
        ),
        "grid": Call(
            dx.grid, ("a_C",), {"theta": [0.0, 1.0], **MACHINE}, ("reduce", "alpha", "accuracy", "out")
        ),
        "peak": Call(dx.peak, ("a_C",), dict(MACHINE), ("theta", "kind", "accuracy", "threads", "branch")),
        "inverse": Call(dx.inverse, (), {"Y": 0.3, **LENGTHS}, ("branch", "V_C", "a_C")),
        "inverse from a dead centre": Call(dx.inverse, (), {"s": 0.01, **LENGTHS}, ("branch", "V_C", "a_C")),
        "crossings": Call(dx.crossings, ("a_C",), {"value": 1.0, **MACHINE}, ("branch", "m_rod")),
        "solve": Call(
            dx.solve,
            (),
            {"over": {"AB": (0.05, 0.1)}, "stroke": 0.15, "ec": 0.01, "BC": 0.35, "timeout": 5.0},
            ("where", "branch", "omega0"),
        ),
        "events": Call(dx.events, (), dict(LENGTHS)),
        "feasibility": Call(dx.feasibility, (), dict(LENGTHS)),
        "harmonics": Call(dx.harmonics, ("a_C",), dict(MACHINE)),
        "enclose": Call(dx.enclose, ("Y",), {"theta": 1.0, **LENGTHS}, ("boxes", "rtol", "branch")),
        "synthesize": Call(
            dx.synthesize, (), {"stroke": 0.1, "time_ratio": 1.1, "BC": 0.3}, ("slow_stroke",)
        ),
        "tolerance": Call(
            dx.tolerance,
            ("stroke",),
            {"ec": dx.plus_minus(0.02, 1e-4), "AB": 0.04, "BC": 0.064, "samples": 50},
            ("seed", "sigmas", "distribution", "branch"),
        ),
        "simulate": Call(
            dx.simulate,
            (),
            {"torque": 1.0, "t_end": 0.01, "I_crank": 0.1, **LENGTHS, "timeout": 5.0},
            (
                "theta0",
                "omega_start",
                "rtol",
                "times",
                "until",
                "max_steps",
                "mu",
            ),
        ),
        "simulate sensitivities": Call(
            dx.simulate,
            (),
            {
                "torque": 1.0,
                "t_end": 0.01,
                "I_crank": 0.1,
                **LENGTHS,
                "ec": [0.0, 0.01],
                "wrt": ["ec", "torque"],
                "timeout": 5.0,
            },
            ("theta0", "omega_start", "rtol", "times", "derivative", "max_steps", "mu", "threads"),
        ),
        "optimize": Call(
            dx.optimize,
            (),
            {"maximize": "stroke", "over": {"ec": (0.0, 0.1)}, "AB": 0.125, "BC": 0.35, "timeout": 5.0},
            ("minimize", "keep", "starts", "seed", "points", "branch"),
        ),
        "function": Call(
            evaluated_function,
            ("a_C",),
            {"inputs": ("theta",), **MACHINE},
            ("branch", "accuracy", "alpha", "m_rod"),
        ),
        "drive": Call(
            dx.drive,
            (),
            {"fluctuation": 0.02, "m_slider": 1.0, "F_Y": 10.0, **MACHINE},
            ("alpha", "mu", "branch", "I_rod"),
        ),
        "steady": Call(
            dx.steady,
            (),
            {"torque": 5.0, "m_slider": 1.0, "I_crank": 1.0, "mu": 0.1, **MACHINE},
            ("flywheel_inertia", "fluctuation", "branch", "F_Y", "I_rod"),
        ),
        "over_omega": Call(dx.over_omega, (), {"speeds": [0.0, 10.0], "torques": [5.0, 0.0]}, ("kind",)),
        "kloss": Call(
            dx.kloss,
            (),
            {"breakdown_torque": 10.0, "breakdown_slip": 0.2, "synchronous_speed": 150.0, "gear": 10.0},
        ),
        "Machine": Call(dx.Machine, (), dict(MACHINE), ("units", "branch", "m_slider", "F_Y", "alpha")),
        "Crankshaft": Call(
            crankshaft,
            (dx.Machine(**MACHINE, m_slider=1.0),),
            {"phase": [0.0, 2.0], "bank": 0.5, "spacing": 0.1},
            ("firing", "position", "I_shaft", "units"),
        ),
        "harmonics of a crankshaft": Call(
            dx.harmonics,
            ("T_in",),
            dict(dx.Crankshaft(dx.Machine(**MACHINE), phase=[0.0, 2.0])),
            ("m_slider",),
        ),
        "define": Call(defined, (), {"expression": "k*a_C", "k": 2.0}, ("unit", "meaning")),
        "over_theta": Call(
            dx.over_theta,
            (),
            {"angles": [0.0, 1.0, 2.0], "values": [1.0, 2.0, 1.0]},
            ("kind", "period", "bore", "area", "ambient"),
        ),
        "over_Y": Call(dx.over_Y, (), {"positions": [0.1, 0.2], "outward": [1.0, 2.0]}, ("inward", "kind")),
        "over_stroke": Call(
            dx.over_stroke,
            (),
            {"distances": [0.0, 0.2], "outward": [1.0, 2.0], "dead_centre": "outer"},
            ("inward", "kind"),
        ),
        "over_V": Call(dx.over_V, (), {"speeds": [-1.0, 1.0], "forces": [5.0, -5.0]}, ("kind", "derivative")),
        "spring": Call(dx.spring, (), {"stiffness": 4e3, "free": 0.1}),
        "damper": Call(dx.damper, (), {"linear": 200.0, "quadratic": 3.0}),
        "fit": Call(
            dx.fit,
            (SAMPLES,),
            {"over": {"AB": (0.1, 0.2)}, "ec": 0.01, "BC": 0.35},
            ("sigma", "nuisance", "loss", "branch"),
        ),
        "between": Call(dx.between, (), {"low": 0.0, "high": 1.0}),
        "plus_minus": Call(dx.plus_minus, (), {"value": 1.0, "tolerance": 0.1}),
        "equation": Call(dx.equation, (), {"name": "a_C"}, ("form",)),
        "design_map": Call(
            dx.design_map, (), {"ec": [0.0, 0.01], "AB": 0.125, "BC": 0.35}, ("names", "branch")
        ),
        "sweep": Call(
            dx.sweep,
            ("a_C",),
            {"theta": [0.0, 1.0], "reduce": {"theta": "max"}, **MACHINE},
            ("memory", "chunks"),
        ),
        "scene": Call(dx.scene, (), {"source": SCENE}),
        "explain": Call(dx.explain, (), {"scene": SCENE}),
        **{
            f"compile to {to}": Call(written(dx.compile), (SCENE,), {"to": to}, ("check", "overwrite"))
            for to in (*(language.name for language in languages()), "fmu")
        },
        "explore": Call(written(dx.explore), (SCENE,), {}, ("branch", "title", "units", "names")),
        "explore under a load": Call(
            written(dx.explore),
            (None,),
            {"F_Y": dx.spring(4e3, 0.05) - dx.damper(30.0), **MACHINE},
            ("names", "g_Y"),
        ),
        "to_excel": Call(written(dx.to_excel), (SAMPLES,), {}, ("units",)),
        "quantities": Call(dx.quantities, (), {}),
        "undefine": Call(dx.undefine, (), {"name": "of_no_fuzz"}),
        "harmonics of a design": Call(dx.harmonics, ("a_C",), dict(MACHINE), ("orders", "branch")),
        "counterweight": Call(
            dx.counterweight, (), {"m_slider": 1.0, **MACHINE}, ("radius", "along", "balance")
        ),
    }


def written(call: Callable[..., Any]) -> Callable[..., Any]:
    """A call that writes a file, into a folder of its own."""

    def write(first: Any, **inputs: Any) -> None:
        with tempfile.TemporaryDirectory() as folder:
            call(first, Path(folder) / f"press{ENDS.get(call.__name__, '.py')}", **inputs)

    return write


def crankshaft(machine: Any, **angles: Any) -> Any:
    return dx.Crankshaft(machine, **angles).evaluate(["T_in", "C_inertia_Y"], theta=1.0)


def evaluated_function(name: str, **inputs: Any) -> Any:
    return dx.function(name, **inputs)(1.0)


def defined(**inputs: Any) -> None:
    try:
        dx.define("of_a_fuzz", **inputs)
    finally:
        if "of_a_fuzz" in dx.quantities():
            dx.undefine("of_a_fuzz")


class _Late(BaseException):
    pass


@contextmanager
def within(seconds: int) -> Iterator[None]:
    def late(number: int, frame: object) -> None:
        raise _Late

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


# What a table of a scene needs besides the key that is exchanged.
TABLES: dict[str, Any] = {
    "check": {"printed": {"a_C": "-994 m/s2"}},
    "claim": {"at": {"ec": 0.01}, "increase": "3 %"},
    "peak": {"quantity": "a_C"},
    "picture": {"file": "a.png", "quantity": "a_C"},
    "quantities": {"expression": "2*a_C"},
    "steady": {"torque": 10.0},
    "kloss": {"breakdown_torque": 40.0, "breakdown_slip": 0.15, "synchronous_speed": 157.0},
}


LISTS = ("check", "claim", "peak", "picture")


def scene_keys() -> list[tuple[str, ...]]:
    """Every key that a scene file can have, from the rules that check it: a new one is here the same day."""

    def keys(rule: dict[str, Any], path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
        for one in rule.get("anyOf", [rule]):
            for name, part in one.get("properties", {}).items():
                yield (*path, name)
                yield from keys(part, (*path, name))
            for inside in ("items", "additionalProperties"):
                yield from keys(one[inside], path) if one.get(inside) else ()

    return list(keys(schema.SCENE, ()))


def scene_with(path: tuple[str, ...], value: Any) -> dict[str, Any]:
    """A scene in which one key has this value."""
    scene = copy.deepcopy(SCENE)
    place = scene
    for name in path[:-1]:
        table = place.get(name)
        if not isinstance(table, dict):  # a number where a table may stand, too
            table = place[name] = copy.deepcopy(TABLES.get(name, {}))
        if name == "quantities":
            table = place[name] = {"own": table}
            table = table["own"]
        elif name in LISTS:
            place[name] = (table,)
        place = table
    place[path[-1]] = value
    return scene


def a_bad_key(folder: Path, random: Random) -> Verdict:
    path, value = random.choice(scene_keys()), random.choice(VALUES)
    words = (*path, *TABLES.get(path[0], ()), *SCENE, *SCENE["mechanism"], *SCENE["motion"])
    return verdict_of(f"scene {'.'.join(path)}", partial(dx.scene, scene_with(path, value)), value, words)


def judged(call: str, name: str, value: Any) -> Verdict:
    function, arguments, inputs, _ = calls()[call]
    run = partial(function, *arguments, **{**inputs, name: value})
    return verdict_of(f"{call}: {name}", run, value, (name, call.split()[0], *inputs))


def verdict_of(what: str, run: Callable[[], Any], value: Any, names: Sequence[str]) -> Verdict:
    """The verdict on a call with this value; a refusal has one of these names in its message."""
    try:
        message = f"{what} = {value!r:.60}"
    except ValueError:
        message = f"{what} = a huge number"
    try:
        with within(SECONDS), warnings.catch_warnings():
            warnings.simplefilter("error")
            for kind in (dx.UnitWarning, dx.LoadWarning):  # which say what they are about
                warnings.simplefilter("ignore", kind)
            warnings.filterwarnings("ignore", ".* goes with the next version", DeprecationWarning)
            run()
    except _Late:
        return Verdict(HUNG, message)
    except (ValueError, TypeError, MemoryError, TimeoutError) as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        ours = "/desaxe/" in last.filename or "/derive/" in last.filename
        words = {
            *names,
            "M_eff",
            "not a quantity",
            "of_a_fuzz",
            "no value",
            "quantity",
            "path",
            "press",  # the file
            "(design)",  # a measure of the user's
        }
        named = any(word in str(error) for word in words) or isinstance(error, (MemoryError, TimeoutError))
        return (
            GOOD
            if ours and named
            else Verdict(CRASHED, f"{message}: {error} ({last.filename}:{last.lineno})")
        )
    except OSError:  # a text where a scene is wanted is the path of one
        return GOOD
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{last.filename}:{last.lineno}"
        return Verdict(CRASHED, f"{message}: {type(error).__name__}: {error} ({where})")
    return GOOD


def a_bad_value(folder: Path, random: Random) -> Verdict:
    call = random.choice([call for call, row in calls().items() if row.inputs or row.also])
    name = random.choice([*calls()[call].inputs, *calls()[call].also])
    return judged(call, name, random.choice(VALUES))


TRIALS = [
    Trial("a bad value for an input of a public call", a_bad_value, 25, 2000),
    Trial("a bad value for a key of a scene", a_bad_key, 25, 2000),
]
