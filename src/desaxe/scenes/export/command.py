"""`desaxe compile`: write the files of a scene, or show how those that are there differ."""

import difflib
import sys
from pathlib import Path

from ...support.shown import printable
from ..scene import scene as scene_of
from .compile import compile, lost_of, texts_of


def run_compile(source: str, place: str, to: str, libm: bool, check: bool, overwrite: bool) -> int:
    """Write the files, or with `check` compare them; return the exit status."""
    scene = scene_of(source)
    texts = texts_of(scene, Path(place), to, libm)
    if check:
        return _compare(texts, source, place)
    compile(scene, place, to, libm=libm, overwrite=overwrite)
    for file, text in texts.items():
        print(f"{printable(file)}: {len(text.splitlines())} lines")
    lost = lost_of(scene.content, to)
    if lost:
        print(f"not compiled (`desaxe run` has it): {', '.join(lost)}", file=sys.stderr)
    return 0


def _compare(texts: dict[Path, str], source: str, place: str) -> int:
    stale = 0
    for file, text in texts.items():
        there = file.read_bytes().decode(errors="replace") if file.is_file() else ""
        if there != text or not file.is_file():
            stale += 1
            lines = there.splitlines(), text.splitlines()
            names = f"{file} (there)", f"{file} (from the scene)"
            print(*map(printable, difflib.unified_diff(*lines, *names, lineterm="")), sep="\n")
    if stale:
        print(
            f"{printable(place)} is not what {printable(source)} gives: write it again without --check",
            file=sys.stderr,
        )
        return 1
    print(f"{printable(place)}: fresh")
    return 0
