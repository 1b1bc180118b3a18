"""`scene`: a mechanism, its motion and its outputs, from a TOML file or a mapping."""

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from ..mechanism.messages import errors_in
from ..mechanism.own import change, using
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.progress import Progress, progress_bar
from ..support.shown import printable
from .content import Content, Run
from .document.results import files_text, results_text
from .reading.read import plain_data, read
from .reading.values import Value, units_written
from .run import compute, steps_of, write_files
from .schema import SceneError as SceneError


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
    name = printable(source) if isinstance(source, (str, PathLike)) else ""
    try:
        data = plain_data(source)
        content = read(data, None if isinstance(source, Mapping) else Path(source).parent)
        return Scene(content, name, content.units or units_written(data))
    except SceneError as error:
        raise SceneError(f"{name or 'scene'}: {error}") from None
