"""`desaxe run`: the report as soon as everything is computed, then the files."""

import shlex
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from ..mechanism.own import using
from ..support.progress import progress_bar
from ..support.shown import printable
from .document.page import Page, checked
from .document.results import files_text, results_text
from .scene import Scene, compute, steps_of, write_files
from .scene import scene as scene_of


def run_scene(
    source: str,
    overwrite: bool,
    file: str | None = None,
    tolerances: Mapping[str, str] = MappingProxyType({}),
) -> int:
    """Run a scene, print its report, write its files and its page, then OSError for those that failed."""
    with warnings.catch_warnings(record=True) as heard:
        scene = scene_of(source)
    for one in heard:
        warnings.showwarning(one.message, one.category, one.filename, one.lineno)
    content, units, broken = scene.content, scene.shown_in, None
    page = None if file is None else _page(scene, source, overwrite, file, tolerances)
    if page is not None:
        page = checked(page, content, units, [str(one.message) for one in heard])
    steps = steps_of(content, None)
    with using(content.definitions):
        with progress_bar() as steps.watch:
            run = compute(content, steps, overwrite)
        try:
            print(results_text(content, run, units), end="", flush=True)
        except OSError as error:  # whoever reads our output is gone, or the disk of it is full
            broken = error
        with progress_bar() as steps.watch:
            run = write_files(content, run, steps, units, overwrite, page)
    if broken is not None:
        raise broken
    print("".join(f"\n\n{text}" for text in [files_text(content, replace(run, failures=()))] if text))
    if page is not None and page.path in run.files:
        print(f"\nReport\n  {printable(file)}")
    if run.failures:
        raise OSError("; ".join(run.failures))
    return 0


def _page(scene: Scene, source: str, overwrite: bool, file: str, tolerances: Mapping[str, str]) -> Page:
    """The page that is requested, with the command that makes it."""
    words = ["desaxe", "run", source, "--report", file]
    words += [word for name, half in tolerances.items() for word in ("--tolerance", f"{name}={half}")]
    command = shlex.join([*words, *["--overwrite"] * overwrite])
    steady = scene.content.steady
    fluctuation = None if steady is None else steady.fixed.get("fluctuation")
    page = Page(Path(file), command, tolerances, overwrite=overwrite)
    return page._replace(fluctuation=fluctuation) if isinstance(fluctuation, float) else page
