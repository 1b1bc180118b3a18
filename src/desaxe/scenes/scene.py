"""`scene`: a mechanism, its motion and its outputs, from a TOML file or a mapping."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from ..evaluation.in_units import in_units
from ..mechanism.messages import errors_in
from ..mechanism.own import change, using
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.progress import Progress, Steps, progress_bar
from ..support.shown import printable
from ..sweeps.request import RunOptions
from .content import Content, Run
from .document.page import Page, write_page
from .document.results import files_text, results_text
from .parts.grid import blocks_of, sweep_content, values_of_grid
from .parts.motor import steady_of
from .parts.peaks import Peak, peaks_of
from .parts.pictures import draw
from .parts.turning import feasibility_of
from .reading.read import plain_data, read
from .reading.values import Value, units_written
from .schema import SceneError as SceneError
from .stores.files import require_modules, require_places, store_group, write

MOST_BATCHES = 1_000  # of peaks that a run shows beside a store
FAILURES = (OSError, ValueError, RuntimeError, MemoryError)  # of a file that cannot be written


@dataclass(frozen=True, kw_only=True)
class SceneResult(Run):
    """The results of a scene; printed, they are the report.

    dataset      the outputs over the grid of all inputs, labelled, with `status` and `margin`; None
                 where the scene wants none
    peaks        one for each [[peak]]: its `dataset` (`value`, `theta`, `status`, `value_wrt_ec`, ...)
                 and its `claims`
    checks       one for each printed value: `computed` [SI] and whether it `agrees`
    feasibility  how many designs turn fully, and the gaps of those that do not
    files        what was written
    failures     what could not be written, and why: a line for each
    steady       of [steady]: its `dataset` (`omega_mean`, `fluctuation`, `power_mean`, `status`, ...), and
                 `found`, the answer of `desaxe.steady` in SI units
    """

    scene: "Scene"

    def report(self) -> str:
        """The text that `desaxe run` prints."""
        content = self.scene.content
        texts = results_text(content, self, self.scene.shown_in), files_text(content, self)
        return "\n\n".join(filter(None, texts))

    def __str__(self) -> str:
        return self.report()


class NotWrittenError(OSError):
    """Some results could not be written; `result` has all of them, and the files that were."""

    def __init__(self, result: SceneResult) -> None:
        super().__init__("; ".join(result.failures))
        self.result = result


@dataclass(frozen=True)
class Scene:
    """A checked scene in SI units. Scenes with equal content are equal.

    `shown_in` are the units of its report and its pictures: those that it names, else those of its texts.
    """

    content: Content
    name: str = field(default="", compare=False)
    shown_in: UnitSystem = field(default=SI, compare=False)

    @property
    def title(self) -> str:
        """The title of the scene."""
        return self.content.title

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the requested quantities."""
        return self.content.outputs

    @property
    def inputs(self) -> dict[str, Value]:
        """The inputs in SI units in the order given: a number, the values of a list or range, or a load."""
        return dict(self.content.inputs)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the scene with its own quantities, which are registered where it is loaded."""
        return _arrived, (self.content, self.name, self.shown_in)

    def run(self, progress: Progress | None = None, *, overwrite: bool = False) -> SceneResult:
        """Compute everything, write the files that the scene names, and return it.

        `progress(done, total, what)` is called before each step; without, a long run on a terminal shows a
        progress bar. Paths are relative to the current
        directory. A file that desaxe wrote is replaced; another one, or one that was changed since, only
        with `overwrite`. Needs the extra `labelled`, and `plot` where the scene has pictures.

        Raises FileExistsError, ValueError or OSError, before anything is computed, for a place that
        cannot be written; NotWrittenError, which has the result, where writing failed after all.
        """
        meter = progress_bar() if progress is None else nullcontext(progress)
        with meter as watch, using(self.content.definitions), errors_in(self.shown_in):
            steps = steps_of(self.content, watch)
            found = compute(self.content, steps, overwrite)
            found = write_files(self.content, found, steps, self.shown_in, overwrite)
        result = SceneResult(scene=self, **vars(found))
        if found.failures:
            raise NotWrittenError(result)
        return result


def _arrived(content: Content, name: str, shown_in: UnitSystem = SI) -> Scene:
    own = {definition.name: definition for definition in content.definitions}
    change(lambda known: {**own, **known})
    return Scene(content, name, shown_in)


def scene(source: str | PathLike[str] | Mapping[str, Any]) -> Scene:
    """Read and check a scene from a TOML file, or from a mapping of the same form.

    The file is data: nothing in it is ever executed. Quantities that it defines (`[quantities.NAME]`) are
    known to every call from then on, as those of `define` are. Raises SceneError (a ValueError) that
    names the key, its value and what is allowed; OSError where the file cannot be read. Needs the extra
    `units` for a unit that only pint knows.

        dx.scene("examples/compactor.toml").run()

    See docs/choose.md: which call for which question.
    """
    return _scene(source)


def content_of_machine(source: str | PathLike[str] | Mapping[str, Any]) -> Content:
    """The machine and the motor of a scene, whose peaks, checks and pictures may not suit it."""
    return _scene(source, alone=True).content


def _scene(source: str | PathLike[str] | Mapping[str, Any], alone: bool = False) -> Scene:
    name = printable(source) if isinstance(source, (str, PathLike)) else ""
    try:
        data = plain_data(source)
        content = read(data, None if isinstance(source, Mapping) else Path(source).parent, alone=alone)
        return Scene(content, name, content.units or units_written(data))
    except SceneError as error:
        raise SceneError(f"{name or 'scene'}: {error}") from None


# ---- the run: first all that it computes, then the files; one that fails takes nothing else with it


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
