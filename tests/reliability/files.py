"""Trials of files: writers that are killed, two writers at once, disks that are full."""

import resource
import signal
from pathlib import Path
from random import Random

import numpy as np
import openpyxl
import xarray as xr

from desaxe.derive.write import write
from desaxe.scenes.stores import files as results
from desaxe.support import files
from tests.reliability.rig import (
    CRASHED,
    GOOD,
    HUNG,
    LOST,
    RIGHT,
    WRONG,
    Trial,
    Verdict,
    child,
    ended,
    killed_after,
)

NAMES = [f"part_{k}.py" for k in range(9)]
OLD = {name: f"old = {name!r}\n" * 300 for name in (*NAMES, "stale.py")}
NEW = {name: f"new = {name!r}\n" * 300 for name in (*NAMES, "fresh.py")}


def contents(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


def strays(folder: Path) -> list[str]:
    return [
        path.name
        for path in folder.rglob("*")
        if path.name.startswith(".") or path.suffix in (".new", ".tmp")
    ]


def for_ever(work, *sets):
    """The work of a child process: write one set after the other until it is killed."""

    def loop():
        while True:
            for one in sets:
                work(one)

    return loop


def killed_while_writing_generated(folder: Path, random: Random) -> Verdict:
    place = folder / "generated"
    write(OLD, place)
    killed_after(child(for_ever(lambda one: write(one, place), NEW, OLD)), random.uniform(0.0, 0.03))
    if not place.is_dir():
        return Verdict(LOST, "the folder is gone")
    if contents(place) not in (OLD, NEW):
        return Verdict(WRONG, f"a mixed set: {sorted(contents(place))}")
    write(NEW, place)
    write(OLD, place)
    return GOOD if not strays(folder) else Verdict(WRONG, f"left after the next run: {strays(folder)}")


def two_writers_of_generated(folder: Path, random: Random) -> Verdict:
    place = folder / "generated"
    write(OLD if random.random() < 0.5 else {}, place)
    codes = [
        ended(number, 20.0) for number in (child(lambda: write(OLD, place)), child(lambda: write(NEW, place)))
    ]
    if None in codes:
        return Verdict(HUNG, "a writer waits")
    if any(codes):
        return Verdict(CRASHED, f"exit codes {codes}")
    mixed = contents(place) not in (OLD, NEW) or strays(folder)
    return Verdict(WRONG, f"{sorted(contents(place))} {strays(folder)}") if mixed else GOOD


def dataset(value: float) -> xr.Dataset:
    """A result whose numbers are all equal, so that a mixture of two results is recognised."""
    return xr.Dataset({name: ("x", np.full(2000, value), {"units": "m"}) for name in ("a", "b", "c")})


def value_of(path: Path) -> float:
    """The common value of all numbers of a result; NaN if the result is not whole."""
    if path.suffix == ".zarr":
        result = xr.open_zarr(path, consolidated=False).load()
    elif path.suffix == ".nc":
        result = xr.load_dataset(path, engine="h5netcdf")
    elif path.suffix == ".npz":
        with np.load(path) as arrays:
            result = xr.Dataset({name: ("x", arrays[name]) for name in arrays.files})
    elif path.suffix == ".xlsx":
        book = openpyxl.load_workbook(path)
        head, *rows = book["values"].values
        book.close()
        table = dict(zip(head, np.array(rows, dtype=float).T, strict=True))
        result = xr.Dataset({name.partition(" ")[0]: ("x", column) for name, column in table.items()})
    else:
        rows = np.genfromtxt(path, delimiter=",", names=True, skip_header=1)
        result = xr.Dataset({name.partition("_")[0]: ("x", rows[name]) for name in rows.dtype.names})
    numbers = np.stack([result[name].values for name in ("a", "b", "c")])
    return float(numbers[0, 0]) if numbers.shape == (3, 2000) and np.ptp(numbers) == 0.0 else float("nan")


def killed_while_writing_results(folder: Path, random: Random) -> Verdict:
    place = folder / f"values{random.choice(['.zarr', '.zarr', '.nc', '.csv', '.xlsx', '.npz'])}"
    results.write(place, dataset(1.0), {})
    number = child(for_ever(lambda value: results.write(place, dataset(value), {}), 2.0, 1.0))
    killed_after(number, random.uniform(0.0, 0.2))
    try:
        result = value_of(place)
    except Exception as error:
        return Verdict(LOST, f"{place.name}: {type(error).__name__}: {error}")
    if result not in (1.0, 2.0):
        return Verdict(WRONG, f"{place.name}: neither the old nor the new result")
    results.write(place, dataset(3.0), {})
    names = [path.name for path in folder.iterdir()]
    return GOOD if names == [place.name] and value_of(place) == 3.0 else Verdict(WRONG, f"left: {names}")


def limited(place: Path, size: int) -> None:
    """Write a result where no file may grow beyond a size, as on a full disk or under a quota."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    try:
        results.write(place, dataset(2.0), {})
    except OSError as error:
        if str(place) in str(error):
            return
        raise
    raise RuntimeError("written")


def no_room_for_results(folder: Path, random: Random) -> Verdict:
    place = folder / f"values{random.choice(['.zarr', '.nc', '.csv', '.xlsx', '.npz'])}"
    results.write(place, dataset(1.0), {})
    limit = 16 if place.suffix == ".zarr" else random.randrange(16, 4000)  # chunks are compressed
    code = ended(child(lambda: limited(place, limit)), 30.0)
    if code is None:
        return Verdict(HUNG, place.name)
    if code < 0:
        return Verdict(CRASHED, f"{place.name}: signal {-code}")
    if code:
        return Verdict(WRONG, f"{place.name}: no error that names the file")
    if value_of(place) != 1.0:
        return Verdict(LOST, f"{place.name}: the earlier result")
    left = [path.name for path in folder.iterdir() if path != place]
    return Verdict(WRONG, f"{place.name}: left {left}") if left else GOOD


def stopped_between_two_names(folder: Path, random: Random) -> Verdict:
    """A stop between the two renames of a swap: the next writer in the folder restores the old file."""
    stray = folder / f"{files.PREFIX}{random.randrange(10**6)}"
    (stray / "replaced" / "values.zarr").mkdir(parents=True)
    results.write(folder / "other.npz", dataset(1.0), {})
    names = sorted(path.name for path in folder.iterdir())
    return Verdict(RIGHT if names == ["other.npz", "values.zarr"] else LOST, str(names))


TRIALS = [
    Trial("SIGKILL while generated/ is written", killed_while_writing_generated, 2, 200),
    Trial("two writers of generated/ at once", two_writers_of_generated, 2, 300),
    Trial("SIGKILL while results are written (Zarr, NetCDF, CSV, npz)", killed_while_writing_results, 2, 80),
    Trial("no room for results (a limit on file sizes)", no_room_for_results, 1, 40),
    Trial("stopped between two renames", stopped_between_two_names, 1, 5),
]
