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
from .document.content import Page
from .document.write import checked, write_page
from .report import files_report, results_report
from .run import FAILURES, Run, compute, failure, steps_of, write_files
from .scene import Scene
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
    page = None
    if file is not None:
        command, steady = _command(source, overwrite, file, tolerances), scene.content.steady
        page = Page(Path(file), command, tolerances, overwrite=overwrite)
        keep = None if steady is None else steady.fixed.get("fluctuation")
        page = page._replace(fluctuation=keep) if isinstance(keep, float) else page
        page = checked(page, scene.content, scene.shown_in, [str(one.message) for one in heard])
    content, steps = scene.content, steps_of(scene.content, None)
    with using(content.definitions):
        with progress_bar() as steps.watch:
            run = compute(content, steps, overwrite)
        broken = _printed(results_report(content, run, scene.shown_in))
        with progress_bar() as steps.watch:
            run = _with_page(page, scene, write_files(content, run, steps, scene.shown_in, overwrite))
    if broken is not None:  # whoever reads our output is gone, or the disk of it is full
        raise broken
    print("".join(f"\n\n{text}" for text in [files_report(content, replace(run, failures=()))] if text))
    if page is not None and page.path in run.files:
        print(f"\nReport\n  {printable(file)}")
    if run.failures:
        raise OSError("; ".join(run.failures))
    return 0


def _printed(text: str) -> OSError | None:
    try:
        print(text, end="", flush=True)
    except OSError as error:
        return error
    return None


def _with_page(page: Page | None, scene: Scene, run: Run) -> Run:
    """The run with the file of its page, or with why there is none."""
    if page is None:
        return run
    try:
        path = write_page(page, scene.content, run, scene.shown_in)
    except FAILURES as error:
        return replace(run, failures=(*run.failures, failure(str(page.path), error)))
    return replace(run, files=(*run.files, path))


def _command(source: str, overwrite: bool, file: str, tolerances: Mapping[str, str]) -> str:
    words = ["desaxe", "run", source, "--report", file]
    words += [word for name, half in tolerances.items() for word in ("--tolerance", f"{name}={half}")]
    return shlex.join([*words, *["--overwrite"] * overwrite])
