"""`desaxe run`: the report as soon as everything is computed, then the files."""

from ..mechanism.own import using
from ..support.progress import progress_bar
from .report import files_report, report
from .run import compute, steps_of, write_files
from .scene import scene as scene_of


def run_scene(source: str, overwrite: bool) -> int:
    """Run a scene, print its report, write its files; OSError at the end for those that failed."""
    scene = scene_of(source)
    content = scene.content
    steps = steps_of(content, None)
    with using(content.definitions):
        with progress_bar() as steps.watch:
            found = compute(content, steps, overwrite)
        text = report(content, found._replace(failures=()), scene.shown_in)
        broken = _printed(text) if text else None
        with progress_bar() as steps.watch:
            found = write_files(content, found, steps, scene.shown_in, overwrite)
    if broken is not None:  # whoever reads our output is gone, or the disk of it is full
        raise broken
    if found.files:
        print(f"\n{files_report(content, found._replace(failures=()))}".removeprefix("" if text else "\n"))
    if found.failures:
        raise OSError("; ".join(found.failures))
    return 0


def _printed(text: str) -> OSError | None:
    try:
        print(text, flush=True)
    except OSError as error:
        return error
    return None
