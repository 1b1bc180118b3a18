"""`desaxe compile`: write the files of a scene, or show how those that are there differ."""

import difflib
import sys
from pathlib import Path
from zipfile import ZipFile

from ...support.shown import printable
from ..scene import Scene
from ..scene import scene as scene_of
from .compile import compile, lost_of, require_fmu, texts_of
from .fmu.write import stale_fmu, write_fmu
from .portable import Form


def run_compile(
    source: str,
    place: str,
    to: str,
    form: Form,
    check: bool,
    overwrite: bool,
    fmi: int,
    drive: str,
) -> int:
    """Write the files, or with `check` compare them; return the exit status."""
    scene = scene_of(source)
    if to == "fmu":
        require_fmu(Path(place), form)
        return _run_fmu(scene, source, Path(place), check, overwrite, fmi, drive)
    if (fmi, drive) != (3, "torque"):
        raise ValueError("--fmi and --input are for --to fmu")
    texts = texts_of(scene, Path(place), to, form)
    if check:
        return _compare(texts, source, place)
    tables = "arguments" if form.open_tables else "frozen"
    single, libm = form.single, not form.freestanding
    compile(scene, place, to, libm=libm, overwrite=overwrite, float=single, tables=tables)
    for file, text in texts.items():
        print(f"{printable(file)}: {len(text.splitlines())} lines")
    lost = lost_of(scene.content, to)
    if lost:
        print(f"not compiled (`desaxe run` has it): {', '.join(lost)}", file=sys.stderr)
    return 0


def _run_fmu(
    scene: Scene, source: str, place: Path, check: bool, overwrite: bool, fmi: int, drive: str
) -> int:
    if check:
        stale = stale_fmu(scene, place, fmi, drive)
        if stale:
            told = f"{printable(place)} is not what {printable(source)} gives ({', '.join(stale)})"
            print(f"{told}: write it again without --check", file=sys.stderr)
            return 1
        print(f"{printable(place)}: fresh")
        return 0
    write_fmu(scene, place, fmi, drive, overwrite)
    with ZipFile(place) as archive:
        names = ", ".join(archive.namelist())
    print(f"{printable(place)}: FMI {fmi}.0, {names}")
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
