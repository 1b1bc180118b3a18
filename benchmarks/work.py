"""The works that every contender computes, and their inputs.

A work has axes. Random points have one, which every input runs along; a grid has one for each input. Inputs
that are one number for all points are known when the work is prepared, so whoever can folds them.
"""

from collections.abc import Callable, Mapping
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

PARAMETERS = ("theta", "ec", "AB", "BC")
KINEMATICS = ("V_C", "a_C")
FIRST = tuple(f"{q}_wrt_{p}" for q in KINEMATICS for p in PARAMETERS)
SECOND = tuple(
    f"{q}_wrt_{p}_{r}" for q in KINEMATICS for p, r in combinations_with_replacement(PARAMETERS, 2)
)
OMEGA0 = 157.08  # rad/s
RANGES = {"theta": (-7.0, 7.0), "ec": (-0.05, 0.05), "AB": (0.1, 0.15), "BC": (0.3, 0.4)}
ANGLES = 720  # of a sweep
DEGREE = 16  # multiplications and additions at a point, where these are measured
MEMORY = 1 << 22  # doubles: a column that no cache holds
TURNS = 1000  # through a column, where the machine itself is measured
MILLION = 1_000_000


class Inputs(NamedTuple):
    """Each input's column and the axis that it runs along, and the inputs that are numbers."""

    columns: Mapping[str, Array]
    axis: Mapping[str, int]
    scalars: Mapping[str, float]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the result."""
        sizes = {axis: self.columns[name].size for name, axis in self.axis.items()}
        return tuple(sizes[axis] for axis in sorted(sizes))

    def broadcast(self) -> dict[str, Array]:
        """The columns as views that broadcast to the shape."""
        last = len(self.shape) - 1
        return {n: c.reshape((-1,) + (1,) * (last - self.axis[n])) for n, c in self.columns.items()}


class Work(NamedTuple):
    """A work: its names, and a function that makes its inputs from a number of points."""

    key: str
    title: str
    names: tuple[str, ...]
    inputs: Callable[[int], Inputs]
    points: int  # by default
    quick: int  # for a quick run
    kind: str = "values"  # or "prepared"; "grid", with labels; "peak"; "limit", of the machine
    given: bool = True  # the caller gives the memory for the answer
    every_core: bool = False  # measured on all cores too

    @property
    def is_of_points(self) -> bool:
        """True if the work exists at any number of points."""
        return self.inputs in (_random, _concentric)


def _drawn(names: tuple[str, ...], count: int) -> dict[str, Array]:
    rng = np.random.default_rng(1)
    return {name: rng.uniform(*RANGES[name], count) for name in names}


def _random(count: int) -> Inputs:
    return Inputs(_drawn(PARAMETERS, count), dict.fromkeys(PARAMETERS, 0), {"omega0": OMEGA0})


def _with_close(count: int, share: float) -> Inputs:
    """Random points; a share of the rods is only 5 % longer than a full turn needs."""
    points = _random(count)
    columns = points.columns
    close = np.random.default_rng(2).random(count) < share
    shortest = columns["AB"] + np.abs(columns["ec"])
    return points._replace(columns={**columns, "BC": np.where(close, 1.05 * shortest, columns["BC"])})


def _mixed(count: int) -> Inputs:
    return _with_close(count, 0.02)


def _tenth(count: int) -> Inputs:
    return _with_close(count, 0.1)


def _two_fifths(count: int) -> Inputs:
    return _with_close(count, 0.4)


def _close(count: int) -> Inputs:
    return _with_close(count, 1.0)


def _concentric(count: int) -> Inputs:
    names = ("theta", "AB", "BC")
    return Inputs(_drawn(names, count), dict.fromkeys(names, 0), {"ec": 0.0, "omega0": OMEGA0})


def _angles() -> Array:
    return np.linspace(0.0, 2.0 * np.pi, ANGLES)


def _sweep(count: int) -> Inputs:
    """`count` angles of one turn of one mechanism."""
    theta = np.linspace(0.0, 2.0 * np.pi, count)
    return Inputs({"theta": theta}, {"theta": 0}, {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": OMEGA0})


def _sweeps(count: int) -> Inputs:
    """`count` points: random mechanisms, each over the same angles of one turn."""
    designs = _drawn(PARAMETERS[1:], max(1, count // ANGLES))
    axis = {**dict.fromkeys(designs, 0), "theta": 1}
    return Inputs({**designs, "theta": _angles()}, axis, {"omega0": OMEGA0})


def _grid(count: int) -> Inputs:
    """720 x 32 x 16 x 16, or fewer angles and fewer mechanisms."""
    share = (count / (ANGLES * 32 * 16 * 16)) ** 0.25
    sizes = {n: max(2, round(size * share)) for n, size in zip(PARAMETERS, (ANGLES, 32, 16, 16), strict=True)}
    ends = {**RANGES, "theta": (0.0, 2.0 * np.pi)}
    columns = {name: np.linspace(*ends[name], size) for name, size in sizes.items()}
    return Inputs(columns, {name: k for k, name in enumerate(PARAMETERS)}, {"omega0": OMEGA0})


def _designs(count: int) -> Inputs:
    names = PARAMETERS[1:]
    return Inputs(_drawn(names, count), dict.fromkeys(names, 0), {"omega0": OMEGA0})


def _registers(count: int) -> Inputs:
    """A column that stays in the first cache."""
    column = np.random.default_rng(1).uniform(0.5, 2.0, min(count, 1024))
    return Inputs({"theta": column}, {"theta": 0}, {})


def _memory(count: int) -> Inputs:
    """A column that no cache holds."""
    return Inputs({"theta": np.linspace(0.5, 2.0, count)}, {"theta": 0}, {})


def swept(inputs: Inputs, theta_first: bool) -> Inputs:
    """Designs with a further axis of 720 angles, before or after theirs."""
    axis = {**dict.fromkeys(inputs.columns, int(theta_first)), "theta": int(not theta_first)}
    return Inputs({**inputs.columns, "theta": _angles()}, axis, inputs.scalars)


def largest(values: Array, points: Inputs) -> list[Array]:
    """The largest magnitude of each row of a dense grid, and its angle."""
    magnitude = np.abs(values)
    where = magnitude.argmax(axis=1)
    return [np.take_along_axis(magnitude, where[:, None], 1)[:, 0], points.columns["theta"][where]]


GRID = ANGLES * 32 * 16 * 16
WORKS = (
    Work("point", "V_C, a_C at random points", KINEMATICS, _random, MILLION, 40_000, every_core=True),
    Work("first", "the same with 8 first sensitivities", (*KINEMATICS, *FIRST), _random, MILLION, 20_000,
         every_core=True),
    Work("second", "the same with 20 second sensitivities too", (*KINEMATICS, *FIRST, *SECOND), _random,
         MILLION // 4, 10_000, every_core=True),
    Work("audited", "V_C, a_C, a_C_wrt_ec at random points", (*KINEMATICS, "a_C_wrt_ec"), _random, MILLION,
         20_000),
    Work("mixed", "V_C, a_C at random points, of which one in 50 is of a design close to its change point",
         KINEMATICS, _mixed, MILLION, 40_000),
    Work("tenth", "the same where one in 10 is", KINEMATICS, _tenth, MILLION, 40_000),
    Work("fifths", "the same where two in 5 are", KINEMATICS, _two_fifths, MILLION, 40_000),
    Work("close", "the same where all are", KINEMATICS, _close, MILLION, 40_000),
    Work("concentric", "V_C alone, concentric (ec = 0)", ("V_C",), _concentric, MILLION, 40_000),
    Work("sweep", "V_C, a_C of one mechanism at 720 angles", KINEMATICS, _sweep, ANGLES, ANGLES),
    Work("prepared", "the same by a prepared function (desaxe: `function`)", KINEMATICS, _sweep, ANGLES,
         ANGLES, kind="prepared"),
    Work("sweeps", "V_C, a_C of 2,048 mechanisms at 720 angles", KINEMATICS, _sweeps, 2048 * ANGLES,
         32 * ANGLES),
    Work("grid", "a_C on a grid of 720 x 32 x 16 x 16, labelled and allocated", ("a_C",), _grid, GRID, 60_000,
         kind="grid", given=False, every_core=True),
    Work("grid_out", "the same grid into memory of the caller", ("a_C",), _grid, GRID, 60_000, kind="grid",
         every_core=True),
    Work("peak", "peak of a_C over theta for 8,192 designs (others: the best of 720 angles)", ("a_C",),
         _designs, 8192, 64, kind="peak", given=False, every_core=True),
)  # fmt: skip
REGISTERS = {
    "sqrt": "a square root",
    "divide": "a division",
    "sincos": "sine and cosine",
    "multiply_add": "multiplications and additions",
}
LIMITS = (
    *(Work(name, title, (name,), _registers, 1024, 1024, kind="limit") for name, title in REGISTERS.items()),
    Work("copy", "copying a double", ("copy",), _memory, MEMORY, MEMORY, kind="limit"),
)
BY_KEY = {work.key: work for work in (*WORKS, *LIMITS)}
BRIEF = tuple(BY_KEY[key] for key in ("point", "first", "concentric", "grid_out", "peak"))  # of a quick run
