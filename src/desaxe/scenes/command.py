"""`desaxe run`: the report as soon as everything is computed, then the files."""

import warnings
from dataclasses import replace
from typing import Protocol

from ..mechanism.own import using
from ..support.progress import progress_bar
from .report import files_report, report
from .run import Run, compute, steps_of, write_files
from .scene import Scene
from .scene import scene as scene_of


class Page(Protocol):
    """The document of a run."""

    def require(self, scene: Scene, heard: list[str]) -> None:
        """Fail where it cannot be made of this scene; `heard` are the warnings so far."""

    def write(self, scene: Scene, found: Run) -> Run:
        """Write it; the run with its file, or with why there is none."""

    def told(self, found: Run) -> str:
        """The line on its file; empty where there is none."""


def run_scene(source: str, overwrite: bool, page: Page | None = None) -> int:
    """Run a scene, print its report, write its files; OSError at the end for those that failed."""
    with warnings.catch_warnings(record=True) as heard:
        scene = scene_of(source)
    for one in heard:
        warnings.showwarning(one.message, one.category, one.filename, one.lineno)
    content = scene.content
    if page is not None:
        page.require(scene, [str(one.message) for one in heard])
    steps = steps_of(content, None)
    with using(content.definitions):
        with progress_bar() as steps.watch:
            found = compute(content, steps, overwrite)
        text = report(content, replace(found, failures=()), scene.shown_in)
        broken = _printed(text) if text else None
        with progress_bar() as steps.watch:
            found = write_files(content, found, steps, scene.shown_in, overwrite)
            found = found if page is None else page.write(scene, found)
    if broken is not None:  # whoever reads our output is gone, or the disk of it is full
        raise broken
    told = files_report(content, replace(found, failures=()))
    if told:
        print(f"\n{told}".removeprefix("" if text else "\n"))
    if page is not None and (told := page.told(found)):
        print(f"\n{told}")
    if found.failures:
        raise OSError("; ".join(found.failures))
    return 0


def _printed(text: str) -> OSError | None:
    try:
        print(text, flush=True)
    except OSError as error:
        return error
    return None
