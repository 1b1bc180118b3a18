"""Running a scene: first all that it computes, then the files; one that fails takes nothing else with it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..evaluation.in_units import in_units
from ..mechanism.quantity_units import UnitSystem
from ..support.progress import Progress, Steps
from ..support.shown import printable
from ..sweeps.request import RunOptions
from .content import Content, Run
from .document.page import Page, write_page
from .parts.grid import blocks_of, sweep_content, values_of_grid
from .parts.motor import steady_of
from .parts.peaks import Peak, peaks_of
from .parts.pictures import draw
from .parts.turning import feasibility_of
from .stores.files import require_modules, require_places, store_group, write

MOST_BATCHES = 1_000  # of peaks that a run shows beside a store
FAILURES = (OSError, ValueError, RuntimeError, MemoryError)  # of a file that cannot be written


def steps_of(content: Content, watch: Progress | None) -> Steps:
    """The steps of a run, none of them done."""
    stored = content.store is not None
    blocks = blocks_of(content)[0] if content.outputs and not stored else 0
    peaks = sum(one.batches for one in _shown_peaks(content))
    files = len(content.pictures) + (content.data is not None) + (stored and content.steady is not None)
    return Steps(blocks + stored + peaks + files + (content.steady is not None), watch)


def _shown_peaks(content: Content) -> tuple[Peak, ...]:
    """The peaks of the report; where they are too many for it, all of them are in the store."""
    many = content.store is not None and sum(one.batches for one in content.peaks) > MOST_BATCHES
    return () if many else content.peaks


def compute(content: Content, steps: Steps, overwrite: bool) -> Run:
    """Compute all that a scene asks for; nothing is written but its store."""
    require_modules(content)
    require_places(content, overwrite)
    units = content.units
    checks = tuple(check.run(content) for check in content.checks)
    dataset: Any = None
    failures: tuple[str, ...] = ()
    if content.store is not None:
        steps.next(f"sweeping into {content.store}")
        try:  # the steps of the run are shown, not the points of the sweep
            options = RunOptions(overwrite=overwrite, watch=lambda done, total, what: None)
            dataset = sweep_content(content, options)
        except FAILURES as error:
            failures = (_failure(content.store, error),)
    elif content.outputs:
        dataset = in_units(values_of_grid(content, steps), units)
    peaks = [peaks_of(one, content, steps) for one in _shown_peaks(content)]
    steady = None
    if content.steady is not None:
        steps.next("steady state")
        steady = steady_of(content.steady, content)
        steady = steady._replace(dataset=in_units(steady.dataset, units))
    converted = tuple(one._replace(dataset=in_units(one.dataset, units)) for one in peaks)
    return Run(dataset, checks, converted, feasibility_of(content.inputs), (), failures, steady)


def write_files(
    content: Content, run: Run, steps: Steps, shown_in: UnitSystem, overwrite: bool, page: Page | None = None
) -> Run:
    """Write all files of a scene, pictures in the units shown; return the run with files and failures."""
    for name, what, job in _jobs(content, run, shown_in, overwrite):
        steps.next(what)
        run = _attempted(run, name, job)
    if page is not None:
        so_far = run
        run = _attempted(run, str(page.path), lambda: [write_page(page, content, so_far, shown_in)])
    steps.next("")
    return run


def _attempted(run: Run, name: str, job: Callable[[], list[Path]]) -> Run:
    """The run with the files of a job, or with why there are none."""
    try:
        return replace(run, files=(*run.files, *job()))
    except FAILURES as error:
        return replace(run, failures=(*run.failures, _failure(name, error)))


def _jobs(
    content: Content, run: Run, shown_in: UnitSystem, overwrite: bool
) -> Iterator[tuple[str, str, Callable[[], list[Path]]]]:
    """Each file, what is said while it is written, and what writes it."""
    if content.data is not None:
        datasets = [one.dataset for one in (*run.peaks, *([run.steady] if run.steady is not None else []))]
        groups = dict(zip(content.groups, datasets, strict=True))
        job = partial(write, Path(content.data), run.dataset, groups, overwrite)
        yield content.data, f"writing {content.data}", job
    if content.store is not None and run.steady is not None and not run.failures:
        storing = partial(store_group, Path(content.store), "steady", run.steady.dataset)
        yield content.store, f"writing the group steady of {content.store}", storing
    for one in content.pictures:
        yield one.file, f"drawing {one.file}", partial(draw, one, content, shown_in, overwrite)


def _failure(name: str, error: BaseException) -> str:
    """Why a file was not written, beginning with its name."""
    path, why = str(Path(name)), str(error) or type(error).__name__
    if isinstance(error, OSError) and error.strerror:
        why = error.strerror
    return why if why.startswith(path) else f"{printable(path)}: not written: {why}"
