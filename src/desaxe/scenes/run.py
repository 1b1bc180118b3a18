"""Running a scene: first all that it computes, then the files; one that fails takes nothing else with it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ..evaluation.in_units import in_units
from ..mechanism.quantity_units import UnitSystem
from ..support.progress import Progress, Steps
from ..support.shown import printable
from .content import Content
from .parts.checks import CheckResult
from .parts.extremes import Peak, PeakResult, batches, peaks_of
from .parts.grid import blocks_of, values_of_grid
from .parts.motor import steady_of
from .parts.pictures import PictureRequest, draw
from .parts.stored import sweep_content
from .parts.turning import FeasibilityResult, feasibility_of
from .stores.files import store_group, write
from .stores.places import require_modules, require_places

MOST_BATCHES = 1_000  # of peaks that a run shows beside a store
FAILURES = (OSError, ValueError, RuntimeError, MemoryError)  # of a file that cannot be written


@dataclass(frozen=True)
class Run:
    """The results of a run; `failures` lists the files that could not be written, with reasons."""

    dataset: Any  # an xarray.Dataset; None where nothing is requested
    checks: tuple[CheckResult, ...]
    peaks: tuple[PeakResult, ...]
    feasibility: FeasibilityResult | None
    files: tuple[Path, ...] = ()
    failures: tuple[str, ...] = ()
    steady: Any = None  # a MotorResult; None without a motor


def steps_of(content: Content, watch: Progress | None) -> Steps:
    """The steps of a run, none of them done."""
    stored = content.store is not None
    blocks = blocks_of(content)[0] if content.outputs and not stored else 0
    peaks = sum(batches(one) for one in _shown_peaks(content))
    files = len(content.pictures) + (content.data is not None) + (stored and content.steady is not None)
    return Steps(blocks + stored + peaks + files + (content.steady is not None), watch)


def _shown_peaks(content: Content) -> tuple[Peak, ...]:
    """The peaks of the report; where they are too many for it, all of them are in the store."""
    many = content.store is not None and sum(batches(one) for one in content.peaks) > MOST_BATCHES
    return () if many else content.peaks


def compute(content: Content, steps: Steps, overwrite: bool) -> Run:
    """Compute all that a scene asks for; nothing is written but its store."""
    require_modules(content)
    require_places(content, overwrite)
    checks = tuple(check.run(content) for check in content.checks)
    dataset: Any = None
    failures: tuple[str, ...] = ()
    if content.store is not None:
        steps.next(f"sweeping into {content.store}")
        try:
            dataset = sweep_content(content, watch=_no_watch, overwrite=overwrite)
        except FAILURES as error:
            failures = (failure(content.store, error),)
    elif content.outputs:
        dataset = in_units(values_of_grid(content, steps), content.units)
    peaks = tuple(_peaks(one, content, steps) for one in _shown_peaks(content))
    steady = None
    if content.steady is not None:
        steps.next("steady state")
        steady = steady_of(content.steady, content)
        steady = steady._replace(dataset=in_units(steady.dataset, content.units))
    return Run(dataset, checks, peaks, feasibility_of(content.inputs), (), failures, steady)


def write_files(content: Content, found: Run, steps: Steps, shown_in: UnitSystem, overwrite: bool) -> Run:
    """Write all files of a scene, pictures in the units shown; return the run with files and failures."""
    files, failures = list(found.files), list(found.failures)
    for name, what, job in _jobs(content, found, shown_in, overwrite):
        steps.next(what)
        try:
            files += job()
        except FAILURES as error:
            failures.append(failure(name, error))
    steps.next("")
    return replace(found, files=tuple(files), failures=tuple(failures))


def _jobs(
    content: Content, found: Run, shown_in: UnitSystem, overwrite: bool
) -> list[tuple[str, str, Callable[[], list[Path]]]]:
    """Each file, what is said while it is written, and what writes it."""
    jobs: list[tuple[str, str, Callable[[], list[Path]]]] = []
    if content.data is not None:
        datasets = [one.dataset for one in found.peaks]
        datasets += [found.steady.dataset] if found.steady is not None else []
        groups = dict(zip(content.groups, datasets, strict=True))
        job = partial(write, Path(content.data), found.dataset, groups, overwrite)
        jobs.append((content.data, f"writing {content.data}", job))
    if content.store is not None and found.steady is not None and not found.failures:
        storing = partial(store_group, Path(content.store), "steady", found.steady.dataset)
        jobs.append((content.store, f"writing the group steady of {content.store}", storing))
    for picture in content.pictures:
        drawing = partial(_drawn, picture, content, shown_in, overwrite)
        jobs.append((picture.file, f"drawing {picture.file}", drawing))
    return jobs


def _drawn(picture: PictureRequest, content: Content, shown_in: UnitSystem, overwrite: bool) -> list[Path]:
    return [draw(picture, content, shown_in, overwrite)]


def failure(name: str, error: BaseException) -> str:
    """Why a file was not written, beginning with its name."""
    path, why = str(Path(name)), str(error) or type(error).__name__
    if isinstance(error, OSError) and error.strerror:
        why = error.strerror
    return why if why.startswith(path) else f"{printable(path)}: not written: {why}"


def _peaks(one: Peak, content: Content, steps: Steps) -> PeakResult:
    """Peaks in the units of the scene."""
    found = peaks_of(one, content, steps)
    return found._replace(dataset=in_units(found.dataset, content.units))


def _no_watch(done: int, total: int, what: str) -> None:
    """The steps of the run are shown, not the points of the sweep."""
