"""`desaxe run`: the report as soon as everything is computed, then the files."""

import shlex
import warnings
from collections.abc import Mapping
from os.path import abspath
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..mechanism.own import using
from ..support.forks import IMPORTS
from ..support.progress import progress_bar
from ..support.shown import printable
from .report import files_report, report
from .run import FAILURES, Run, compute, failure, steps_of, write_files
from .scene import Scene
from .scene import scene as scene_of

NONE: Mapping[str, str] = MappingProxyType({})


def run_scene(
    source: str, overwrite: bool, page: str | None = None, tolerances: Mapping[str, str] = NONE
) -> int:
    """Run a scene, print its report, write its files; OSError at the end for those that failed.

    page        the file of a report as a document, .html or .md
    tolerances  input -> half its range as text, for that document
    """
    with warnings.catch_warnings(record=True) as heard:
        scene = scene_of(source)
    for one in heard:
        warnings.showwarning(one.message, one.category, one.filename, one.lineno)
    content = scene.content
    asked = None if page is None else _asked(scene, source, page, overwrite, tolerances, heard)
    steps = steps_of(content, None)
    with using(content.definitions):
        with progress_bar() as steps.watch:
            found = compute(content, steps, overwrite)
        text = report(content, found._replace(failures=()), scene.shown_in)
        broken = _printed(text) if text else None
        with progress_bar() as steps.watch:
            found = write_files(content, found, steps, scene.shown_in, overwrite)
            if asked is not None and page is not None:
                found = _with_page(scene, found, Path(page), overwrite, asked)
    if broken is not None:  # whoever reads our output is gone, or the disk of it is full
        raise broken
    told = files_report(content, found._replace(failures=()))
    if told:
        print(f"\n{told}".removeprefix("" if text else "\n"))
    if page is not None and Path(page) in found.files:
        print(f"\nReport\n  {printable(page)}")
    if found.failures:
        raise OSError("; ".join(found.failures))
    return 0


def _printed(text: str) -> OSError | None:
    try:
        print(text, flush=True)
    except OSError as error:
        return error
    return None


def _asked(
    scene: Scene, source: str, page: str, overwrite: bool, tolerances: Mapping[str, str], heard: list[Any]
) -> Any:
    """The options of the document; ValueError or OSError for a place or tolerance that is bad."""
    with IMPORTS:
        from .document.content import Asked, require_drawing
        from .document.spread import read_tolerances
        from .document.write import require_document

    require_drawing()
    require_document(Path(page), overwrite)
    content = scene.content
    others = [content.data, content.store, *(picture.file for picture in content.pictures)]
    if abspath(page) in [abspath(other) for other in others if other is not None]:
        raise ValueError(f"--report {printable(page)}: another result of the scene is written there")
    words = ["desaxe", "run", source, "--report", page]
    words += [word for name, half in tolerances.items() for word in ("--tolerance", f"{name}={half}")]
    found = read_tolerances(content, scene.shown_in, tolerances)
    return Asked(
        shlex.join([*words, *["--overwrite"] * overwrite]), tuple(str(one.message) for one in heard), found
    )


def _with_page(scene: Scene, found: Run, page: Path, overwrite: bool, asked: Any) -> Run:
    """Write the document, and tell of it, or of why it is not there, with the other files."""
    with IMPORTS:
        from .document.content import document_of
        from .document.write import write_document

    try:
        path = write_document(document_of(scene.content, found, scene.shown_in, asked), page, overwrite)
    except FAILURES as error:
        return found._replace(failures=(*found.failures, failure(str(page), error)))
    return found._replace(files=(*found.files, path))
