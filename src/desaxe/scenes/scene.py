"""`scene`: a mechanism, its motion and its outputs, from a TOML file or a mapping; its run and its report."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from ..mechanism.messages import errors_in
from ..mechanism.own import change, using
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.progress import Progress, Steps, progress_bar
from ..support.shown import printable
from .content import Content, RequestAnswer, RequestPlan, Run, Sink
from .document.blocks import Section, Text, TextTable
from .document.page import Page, write_page
from .document.render import terminal
from .reading.read import plain_data, read
from .reading.values import Value, units_written
from .schema import SceneError as SceneError
from .stores.files import data_files, require_modules, require_places, store_group, write

MOST_BATCHES = 1_000  # of peaks that a run shows beside a store
FAILURES = (OSError, ValueError, RuntimeError, MemoryError)  # of a file that cannot be written
Meter = Callable[[], AbstractContextManager[Progress | None]]


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
        meter = progress_bar if progress is None else partial(nullcontext, progress)
        run = run_content(self.content, self.shown_in, overwrite, meter)
        result = SceneResult(scene=self, **vars(run))
        if run.failures:
            raise NotWrittenError(result)
        return result


def _arrived(content: Content, name: str, shown_in: UnitSystem = SI) -> Scene:
    own = {definition.name: definition for definition in content.definitions}
    change(lambda known: {**own, **known})
    return Scene(content, name, shown_in)


def scene(source: str | PathLike[str] | Mapping[str, Any]) -> Scene:
    """Read and check a scene from a TOML file or a mapping of the same form.

    The file is data: nothing in it is ever executed. Quantities that it defines (`[quantities.NAME]`) are
    known to every later call, like those of `define`. Raises SceneError (a ValueError) that
    names the key, its value and the allowed values; OSError if the file cannot be read. Needs the extra
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


def run_content(
    content: Content,
    units: UnitSystem,
    overwrite: bool,
    meter: Meter,
    report: Callable[[Run], None] = lambda run: None,
    page: Page | None = None,
) -> Run:
    """Compute everything, `report` it, then write the files, pictures and page; all in these units."""
    files = len(content.of("picture")) + (content.data is not None) + (page is not None)
    steps = steps_of(content)
    steps.total += files + (content.store is not None and bool(content.of("steady")))
    with using(content.definitions), errors_in(units):
        with meter() as steps.watch:
            run = compute(content, Sink(steps, overwrite))
        report(run)
        with meter() as steps.watch:
            for name, job in _jobs(content, run, Sink(steps, overwrite, units)):
                run = _attempted(run, name, job)
            if page is not None:
                so_far = run
                steps.next(f"writing {page.path.name}")
                run = _attempted(run, str(page.path), lambda: [write_page(page, content, so_far, units)])
            steps.next("")
    return run


def steps_of(content: Content) -> Steps:
    """The steps of what a scene computes, none of them done."""
    return Steps(sum(plan.steps for plan in _plans(content)), None)


def _plans(content: Content) -> list[RequestPlan]:
    """The plans of all requests but pictures; peaks that are too many for a report are in the store alone."""
    many = content.store is not None and sum(one.batches for one in content.peaks) > MOST_BATCHES
    left = ("picture", "peak") if many else ("picture",)
    return [one.plan(content) for one in content.requests if one.key not in left]


def compute(content: Content, sink: Sink) -> Run:
    """Compute all that a scene asks for; nothing is written but its store, which stays in SI units."""
    require_modules(content)
    require_places(content, sink.overwrite)
    answers: list[RequestAnswer] = []
    failures: list[str] = []
    for plan in _plans(content):
        try:
            answers.append(plan.run(sink) if plan.file else plan.run(sink).to(content.units))
        except FAILURES as error:
            if plan.file is None:
                raise
            failures.append(_failure(plan.file, error))
    return Run(answers=tuple(answers), failures=tuple(failures))


def _attempted(run: Run, name: str, job: Callable[[], list[Path]]) -> Run:
    """The run with the files of a job, or with why there are none."""
    try:
        return replace(run, files=(*run.files, *job()))
    except FAILURES as error:
        return replace(run, failures=(*run.failures, _failure(name, error)))


def _jobs(content: Content, run: Run, sink: Sink) -> Iterator[tuple[str, Callable[[], list[Path]]]]:
    """Each file, and what writes it."""
    if content.data is not None:
        datasets = [one.dataset for one in run.answers if one.key in ("peak", "steady")]
        groups = dict(zip(content.groups, datasets, strict=True))
        sink.steps.next(f"writing {content.data}")
        yield content.data, partial(write, Path(content.data), run.dataset, groups, sink.overwrite)
    if content.store is not None and run.steady is not None and not run.failures:
        sink.steps.next(f"writing the group steady of {content.store}")
        yield content.store, partial(store_group, Path(content.store), "steady", run.steady.dataset)
    for one in content.of("picture"):
        yield one.file, partial(one.plan(content).run, sink)


def _failure(name: str, error: BaseException) -> str:
    """Why a file was not written, beginning with its name."""
    path, why = str(Path(name)), str(error) or type(error).__name__
    if isinstance(error, OSError) and error.strerror:
        why = error.strerror
    return why if why.startswith(path) else f"{printable(path)}: not written: {why}"


# ---- the report ------------------------------------------------------------------------------------


def results_text(content: Content, run: Run, units: UnitSystem) -> str:
    """The results in these units as text for a terminal."""
    return terminal(content.title, run.blocks(content, units))


def files_text(content: Content, run: Run) -> str:
    """The files that were written, and those that were not, as text."""
    return terminal("", [*_files(content, run)])


def _files(content: Content, run: Run) -> Iterator[Section]:
    """A row for each file that was written, and a line for each that was not."""
    paths = [str(file) for file in data_files(content) if file in run.files]
    parts = ["the values"] * bool(content.outputs) + [f"group {name}" for name in content.groups]
    rows = [*zip([*paths, *[""] * len(parts)], parts, strict=False)] if paths else []
    pictures = [one for one in content.of("picture") if Path(one.file) in run.files]
    rows += [(one.file, f"{one.quantity} over {one.over}") for one in pictures]
    if rows:
        yield Section("Written", [TextTable(("", ""), rows)])
    elif run.dataset is not None and content.data is None and content.store is None:
        yield Section("Not kept in a file", [Text('give [results] data = "out/values.nc"')])
    if run.failures:
        yield Section("Not written", [Text(failure) for failure in run.failures])
