"""`desaxe run`: the report as soon as everything is computed, then the files."""

import shlex
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from ..support.progress import Steps, progress_bar
from ..support.shown import printable
from .content import Content, Run
from .document.page import Page, checked
from .scene import files_text, results_text, run_content
from .scene import scene as scene_of


def run_scene(
    source: str,
    overwrite: bool,
    file: str | None = None,
    tolerances: Mapping[str, str] = MappingProxyType({}),
) -> int:
    """Run a scene, print its report, write its files and its page, then OSError for those that failed."""
    with progress_bar() as watch, warnings.catch_warnings(record=True) as heard:
        Steps(1, watch).report(f"reading {printable(source)}")
        scene = scene_of(source)
        content, units, page = scene.content, scene.shown_in, None
        if file is not None:
            page = checked(_page(content, source, overwrite, file, tolerances), content, units)
    for one in heard:
        warnings.showwarning(one.message, one.category, one.filename, one.lineno)
    if page is not None:
        page = page._replace(warnings=tuple(str(one.message) for one in heard))
    broken: list[OSError] = []

    def report(run: Run) -> None:
        try:
            print(results_text(content, run, units), end="", flush=True)
        except OSError as error:  # whoever reads our output is gone, or the disk of it is full
            broken.append(error)

    run = run_content(content, units, overwrite, progress_bar, report, page)
    if broken:
        raise broken[0]
    print("".join(f"\n\n{text}" for text in [files_text(content, replace(run, failures=()))] if text))
    if page is not None and page.path in run.files:
        print(f"\nReport\n  {printable(file)}")
    if run.failures:
        raise OSError("; ".join(run.failures))
    return 0


def _page(content: Content, source: str, overwrite: bool, file: str, tolerances: Mapping[str, str]) -> Page:
    """The page that is requested, with the command that makes it."""
    words = ["desaxe", "run", source, "--report", file]
    words += [word for name, half in tolerances.items() for word in ("--tolerance", f"{name}={half}")]
    page = Page(
        Path(file), shlex.join([*words, *["--overwrite"] * overwrite]), tolerances, overwrite=overwrite
    )
    fluctuation = next((one.fixed.get("fluctuation") for one in content.of("steady")), None)
    return page._replace(fluctuation=fluctuation) if isinstance(fluctuation, float) else page
