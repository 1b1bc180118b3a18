"""`desaxe compile`: write the files of a scene, or show how those that are there differ."""

import sys
from collections.abc import Sequence
from pathlib import Path

from ...support.shown import printable
from ...support.written import Generated
from ..scene import scene as scene_of
from .compile import generated, lost_of


def run_compile(
    source: str,
    place: str,
    to: str,
    check: bool,
    overwrite: bool,
    drive: str,
) -> int:
    """Write the files, or with `check` compare them; return the exit status."""
    if to != "fmu" and drive != "torque":
        raise ValueError("--input is for --to fmu")
    scene = scene_of(source)
    made = generated(scene, Path(place), to, drive)
    lost = [] if to == "fmu" else lost_of(scene.content, to)
    return write_files(made, source, place, check, overwrite, lost)


def write_files(
    made: Generated, source: str, place: str, check: bool, overwrite: bool, lost: Sequence[str] = ()
) -> int:
    """Write files of a scene, or compare them; `lost` is what they leave out. Return the exit status."""
    if check:
        lines = [*map(printable, made.diff())]
        print(*lines, *([] if lines else [f"{printable(place)}: fresh"]), sep="\n")
        if lines:
            message = f"{printable(place)} is not what {printable(source)} gives"
            print(f"{message}: write it again without --check", file=sys.stderr)
        return 1 if lines else 0
    made.write(overwrite)
    print(*map(printable, made.summary()), sep="\n")
    if lost:
        print(f"not compiled (`desaxe run` has it): {', '.join(lost)}", file=sys.stderr)
    return 0
