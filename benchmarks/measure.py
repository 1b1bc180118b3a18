"""The whole run: all data of the report, as plain data."""

import os
import platform
import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding

from desaxe.mechanism.program import Variant
from desaxe.runtime.specialise import specialise
from desaxe.support.progress import Progress, Steps

from . import growth, startup
from .contenders import CONTENDERS, LIMITS, MACHINE
from .errors import FAMILIES, cases, errors
from .load import load_of
from .race import Found, race, racers
from .starts import starts
from .work import BRIEF, WORKS, Work
from .work import LIMITS as MACHINE_WORKS

PACKAGES = ("desaxe", "numpy", "numba", "llvmlite", "sympy", "numexpr", "jax", "casadi", "heyoka")
Data = dict[str, Any]


class Effort(NamedTuple):
    """The effort of a run: rounds and numbers of points."""

    quick: bool
    rounds: int
    points: int | None = None  # of the works at random points
    judged: int = 200  # points of each family

    def count(self, work: Work) -> int:
        """The number of points of a work."""
        if self.points is not None and work.is_of_points:
            return self.points
        return work.quick if self.quick else work.points


FULL = Effort(quick=False, rounds=9)
QUICK = Effort(quick=True, rounds=2, judged=10)


def measure(works: Sequence[Work], effort: Effort, watch: Progress | None = None) -> Data:
    """Race everyone at these works; all else (cores, growth, starts) belongs to a run of all works."""
    if not works:
        return {"machine": _machine(len(_cores())), "calls": startup.measure(effort.rounds)}
    whole = len(works) == len(BRIEF if effort.quick else WORKS)
    here, cores = [one for one in CONTENDERS if one.is_here], _cores()
    several = [work for work in works if work.every_core and len(cores) > 1 and not effort.quick]
    steps = Steps(len(works) + len(several) + 3 * whole + 2, watch)
    data: Data = {
        "machine": _machine(len(cores)),
        "rounds": effort.rounds,
        "who": [one.name for one in here],
        "absent": [f"{one.name} ({one.needs})" for one in CONTENDERS if not one.is_here],
        "points": {work.key: effort.count(work) for work in works},
    }
    with tempfile.TemporaryDirectory() as folder:
        before = os.environ.get("NUMBA_CACHE_DIR")
        os.environ["NUMBA_CACHE_DIR"] = folder  # of the children: what compilation takes is measured
        steps.next("processes")
        with racers([*here, MACHINE], cores[-1:]) as who:
            data["one core"] = {}
            for work in works:
                steps.next(work.title)
                data["one core"][work.key] = _plain(race(who, work, effort.count(work), effort.rounds))
            limits = {LIMITS: who.pop(LIMITS)}
            data["limits"] = {
                work.key: _plain(race(limits, work, work.points, 3 * effort.rounds))[LIMITS]["seconds"]
                for work in MACHINE_WORKS
            }
            steps.next("errors")
            judged = {family: cases(family, effort.judged) for family in FAMILIES}
            data["errors"] = {
                one.name: {f: list(result) for f, result in errors(one, who[one.name], judged).items()}
                for one in here
            }
            if whole:
                steps.next("how the time grows")
                data["growth"] = growth.growth(
                    who, growth.QUICK if effort.quick else growth.SIZES, effort.rounds
                )
            limits[LIMITS].stop()
        if several:
            with racers([*here, MACHINE], cores) as who:
                data["all cores"] = {}
                for work in several:
                    steps.next(f"{work.title}, on {len(cores)} cores")
                    data["all cores"][work.key] = _plain(race(who, work, effort.count(work), effort.rounds))
        del os.environ["NUMBA_CACHE_DIR"]
        if before is not None:
            os.environ["NUMBA_CACHE_DIR"] = before
    if whole and not effort.quick:
        steps.next("new processes")
        data["starts"] = starts(here, cores[-1], 2)
        data["calls"] = startup.measure(2)
    data["operations"] = {
        work.key: _operations(work) for work in works if work.kind in ("values", "prepared")
    }
    data["load"] = {
        work.key: load_of(work)._asdict() for work in works if work.kind in ("values", "prepared", "grid")
    }
    return data


def _plain(result: dict[str, Found | str]) -> Data:
    """The measurements as plain data for JSON."""
    return {n: one._asdict() if isinstance(one, Found) else {"refused": one} for n, one in result.items()}


def _operations(work: Work) -> int:
    """Operations at each point for the requested names, a sine or a root counted as one."""
    zeros = {"alpha": 0.0, **{n: x for n, x in work.inputs(1).scalars.items() if x == 0.0}}
    return len(specialise(work.names, Variant(), tuple(sorted(zeros.items()))).lines)


def _cores() -> list[int]:
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def _machine(cores: int) -> str:
    """The processor and every version that counts."""
    versions = []
    for package in PACKAGES:
        try:
            versions.append(f"{package} {version(package)}")
        except ModuleNotFoundError:
            continue
    vectors = [
        name for name in ("avx2", "avx512f", "neon") if llvmlite.binding.get_host_cpu_features().get(name)
    ]
    cpu = f"{_processor()} ({llvmlite.binding.get_host_cpu_name()}, {', '.join(vectors)}), {cores} cores"
    python = f"Python {platform.python_version()}"
    return ", ".join([platform.system(), platform.machine(), cpu, python, *versions])


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "processor unknown"
