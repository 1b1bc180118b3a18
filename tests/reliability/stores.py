"""Trials of Zarr stores: damaged ones, two sweeps into one place, disks that are full."""

import json
import os
import subprocess
import sys
import tempfile
import traceback
from functools import cache
from pathlib import Path
from random import Random
from shutil import copytree, which

import numpy as np
import xarray as xr

import desaxe as dx
from tests.reliability.rig import CRASHED, GOOD, HUNG, LOST, WRONG, Trial, Verdict, child, ended

INPUTS = {
    "theta": np.linspace(0.0, 6.0, 20),
    "ec": [-0.05, 0.0, 0.9],
    "AB": 0.2,
    "BC": [0.3, 0.5],
    "omega0": 3.0,
}
KINDS = {
    "grid": {"names": ["V_C", "a_C"], "chunks": {"theta": 8}},
    "reduced": {"names": "a_C", "reduce": {"theta": "absmax"}, "peaks": ["a_C"]},
}


def sweep(kind: str, root: Path, **more: object) -> xr.Dataset:
    """The sweep of a kind, loaded without Dask's threads, which a forked child would wait for."""
    return dx.sweep(store=root, **KINDS[kind], **INPUTS, **more).load(scheduler="synchronous")


_FOLDER = tempfile.TemporaryDirectory(prefix="desaxe-stores-")  # of this process


@cache
def whole(kind: str) -> Path:
    """A store of an undisturbed sweep."""
    root = Path(_FOLDER.name) / f"{kind}.zarr"
    sweep(kind, root)
    return root


# ---- damage ----------------------------------------------------------------------------------------


def cut(path: Path, random: Random) -> None:
    path.write_bytes(path.read_bytes()[: random.randrange(max(path.stat().st_size, 1))])


def flipped(path: Path, random: Random) -> None:
    data = bytearray(path.read_bytes())
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def gone(path: Path, random: Random) -> None:
    path.unlink()


def a_folder(path: Path, random: Random) -> None:
    path.unlink()
    path.mkdir()


def a_pipe(path: Path, random: Random) -> None:
    path.unlink()
    os.mkfifo(path)


def other_bytes(path: Path, random: Random) -> None:
    path.write_bytes(random.randbytes(random.choice([0, 1, 100])))


OTHERS = [
    None,
    True,
    -1,
    0,
    1.5,
    10**30,
    "",
    "x",
    "[]",
    "{}",
    [],
    [1],
    {},
    {"ec": 0},
    {"a": {"b": None}},
    "\ud800",
]


def other_json(path: Path, random: Random) -> None:
    """A value somewhere in a JSON file is another, or is not there."""
    if path.suffix != ".json":
        flipped(path, random)
        return
    table = json.loads(path.read_text())
    place = table
    while True:
        key = random.choice(list(place) if isinstance(place, dict) else list(range(len(place))))
        inside = place[key]
        if not (isinstance(inside, (dict, list)) and inside) or random.random() < 0.3:
            break
        place = inside
    if random.random() < 0.4:
        del place[key]
    else:
        place[key] = random.choice(OTHERS)
    path.write_text(json.dumps(table))


DAMAGES = [cut, flipped, gone, a_folder, a_pipe, other_bytes, *[other_json] * 6]


def damaged_store(folder: Path, random: Random) -> Verdict:
    """A damaged store is mended or refused in a line that names it; `overwrite=True` makes it anew."""
    kind, root = random.choice(list(KINDS)), folder / "press.zarr"
    copytree(whole(kind), root)
    path = random.choice(sorted(path for path in root.rglob("*") if path.is_file()))
    damage = random.choice(DAMAGES)
    damage(path, random)
    message = f"{kind}: {damage.__name__} {path.relative_to(root)}"
    for overwrite in (False, True):
        try:
            if sweep(kind, root, overwrite=overwrite).identical(sweep(kind, whole(kind))):
                continue
            return Verdict(WRONG, f"{message}: other values, overwrite={overwrite}")
        except (ValueError, OSError) as error:
            ours = "/desaxe/" in traceback.extract_tb(error.__traceback__)[-1].filename
            if not (ours and str(root) in str(error) and "\n" not in str(error)):
                return Verdict(CRASHED, f"{message}: {type(error).__name__}: {error}")
            if overwrite and "this is no Zarr store" not in str(error):
                return Verdict(LOST, f"{message}: {error}")
        except Exception as error:
            return Verdict(CRASHED, f"{message}: {type(error).__name__}: {error}")
    left = [one.name for one in folder.iterdir() if one != root]
    return Verdict(WRONG, f"{message}: left {left}") if left else GOOD


# ---- two at once -----------------------------------------------------------------------------------


def two_sweeps(folder: Path, random: Random) -> Verdict:
    """Two sweeps into one place: each is done, or says that another is writing; one is done."""
    kind, root = random.choice(list(KINDS)), folder / "press.zarr"
    whole(kind)
    if random.random() < 0.3:
        root.mkdir()

    def work() -> None:
        try:
            sweep(kind, root)
        except BlockingIOError as error:
            if "another sweep is writing this store" in str(error):
                os._exit(7)
            raise

    codes = [ended(number, 60.0) for number in [child(work) for _ in range(3)]]
    if None in codes:
        return Verdict(HUNG, f"{kind}: {codes}")
    if not set(codes) <= {0, 7} or 0 not in codes:
        return Verdict(CRASHED, f"{kind}: {codes}")
    same = xr.open_zarr(root).load().identical(sweep(kind, whole(kind)))
    left = [one.name for one in folder.iterdir() if one != root]
    return GOOD if same and not left else Verdict(WRONG, f"{kind}: {codes}, left {left}")


# ---- a full disk -----------------------------------------------------------------------------------

SCENE = """
outputs = ["a_C", "V_C"]
mechanism = {AB = 0.125, BC = 0.35, ec = {start = 0, stop = 0.1, num = 100}}
motion = {omega0 = 157, theta = {start = 0, stop = 6, num = 1000}}
"""


# In a mount namespace of its own, which ends with the shell; what is left is listed behind the errors.
ON_A_DISK = """
mount -t tmpfs -o size=400k tmpfs "$1" && head -c "$2" /dev/zero > "$1/filler" || exit 99
cp "$1.toml" "$1/press.toml"; cd "$1"; "$3" -m desaxe run press.toml > /dev/null; code=$?
echo "left:" $(ls -A) >&2; exit $code
"""


def run_on_a_full_disk(folder: Path, random: Random) -> Verdict:
    """`desaxe run` on a disk that is full or nearly so: an error in one line, and nothing is left."""
    end = random.choice([*[".zarr"] * 5, ".nc", ".csv", ".npz"])
    key = "store" if end == ".zarr" and random.random() < 0.3 else "data"
    scene, disk = folder / "disk.toml", folder / "disk"
    scene.write_text(f'{SCENE}results = {{{key} = "values{end}"}}\n')
    disk.mkdir()
    filled = 4096 * random.randrange(95)
    command = ["unshare", "--mount", "sh", "-c", ON_A_DISK, "sh", str(disk), str(filled), sys.executable]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120.0)
    *lines, last = done.stderr.splitlines()
    left = set(last.split()[1:]) - {"filler", "press.toml", *([f"values{end}"] if key == "store" else [])}
    message = f"{key} {end}, {filled} bytes filled: {done.returncode}, left {left}: {done.stderr[-300:]}"
    one_line = len(lines) == 1 and lines[0].startswith("desaxe: error: ")
    return GOOD if done.returncode == 2 and one_line and not left else Verdict(WRONG, message)


def _has_disks() -> bool:
    """True if this user can mount a disk of some kilobytes."""
    if os.geteuid() or not which("unshare"):
        return False
    command = ["unshare", "--mount", "sh", "-c", "mount -t tmpfs tmpfs /mnt"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


TRIALS = [
    Trial("a damaged store of a sweep", damaged_store, 2, 400),
    Trial("three sweeps into one place", two_sweeps, 1, 60),
]
if _has_disks():
    TRIALS.append(Trial("`desaxe run` on a full disk", run_on_a_full_disk, 1, 40))
