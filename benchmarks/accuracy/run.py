"""The audit: time per contender, and errors per contender and family of points."""

import platform
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from typing import NamedTuple

import llvmlite.binding

from desaxe.oracle.families import FAMILIES

from .contenders import Contender, contenders
from .errors import Judge, Statistics, cases
from .times import times

GENERIC = "generic"
SEED = 0


class Effort(NamedTuple):
    """The effort of an audit: points per family, branches, timed points, rounds."""

    points: int  # of each family
    branches: tuple[int, ...]
    timed: int  # points in the arrays that are timed
    rounds: int


FULL = Effort(points=500, branches=(1, -1), timed=250_000, rounds=100)
QUICK = Effort(points=12, branches=(1,), timed=250_000, rounds=8)


class Audit(NamedTuple):
    """The result of an audit: times as multiples of desaxe standard's, and errors by contender and family."""

    effort: Effort
    machine: str
    who: tuple[Contender, ...]
    ratios: dict[str, float]
    errors: dict[str, dict[str, Statistics]]

    def hardest(self, name: str) -> tuple[str, float]:
        """The family with the largest share of the promise, generic points aside, and the share."""
        family = max(self.errors[name], key=lambda f: self.errors[name][f].worst if f != GENERIC else -1.0)
        return family, self.errors[name][family].worst

    def worst_ulp(self, name: str) -> float:
        """The largest error in ulp anywhere."""
        return max(result.worst_ulp for result in self.errors[name].values())


def audit(effort: Effort = FULL, watch: Callable[[int, int, str], None] | None = None) -> Audit:
    """Run the audit; `watch(done, total, next_step)` is called before each step."""
    who = contenders()
    total, judges = len(FAMILIES) + 1, {one.name: Judge(one) for one in who}
    errors: dict[str, dict[str, Statistics]] = {one.name: {} for one in who}
    if watch:
        watch(0, total, "times")
    taken = times(who, effort.timed, effort.rounds, SEED)
    for done, family in enumerate(FAMILIES, start=1):
        if watch:
            watch(done, total, family)
        result = cases(family, effort.points, SEED, effort.branches)
        for name, judge in judges.items():
            errors[name][family] = judge.statistics(result)
    ratios = {name: seconds / taken["desaxe standard"] for name, seconds in taken.items()}
    return Audit(effort, _machine(who), tuple(who), ratios, errors)


def _machine(who: list[Contender]) -> str:
    """The processor and every version that counts."""
    packages = ["desaxe", "numba", "numpy", "sympy", "mpmath", "python-flint"]
    versions = [f"{name} {version(name)}" for name in packages]
    if any(one.name == "heyoka" for one in who):
        versions.append(f"heyoka {import_module('heyoka').__version__}")
    python = f"Python {platform.python_version()}"
    cpu = llvmlite.binding.get_host_cpu_name()
    return ", ".join([platform.system(), platform.machine(), f"CPU {cpu}", python, *versions])
