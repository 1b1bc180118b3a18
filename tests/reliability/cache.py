"""Trials of the cache folder: damaged files, files of other users, odd folders."""

import os
import stat
from functools import cache
from pathlib import Path
from random import Random
from shutil import copytree

from tests.reliability.processes import START, run, warm
from tests.reliability.rig import CRASHED, GOOD, HUNG, WRONG, Trial, Verdict

PROGRAM = START + "\nprint(repr(motions()))\n"


@cache
def right() -> str:
    return run(PROGRAM, warm(), 60.0)[1]


def judged(what: str, place: Path, **environment: str) -> Verdict:
    code, out, error = run(PROGRAM, place, 60.0, **environment)
    if code is None:
        return Verdict(HUNG, what)
    if code:
        return Verdict(CRASHED, f"{what}: {code} {error[-300:]}")
    return GOOD if out == right() else Verdict(WRONG, f"{what}: {out}")


def flipped(path: Path, random: Random) -> None:
    data = bytearray(path.read_bytes())
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def cut(path: Path, random: Random) -> None:
    path.write_bytes(path.read_bytes()[: random.randrange(path.stat().st_size)])


def emptied(path: Path, random: Random) -> None:
    path.write_bytes(b"")


def of_another_machine(path: Path, random: Random) -> None:
    path.write_bytes(path.read_bytes().replace(b"llvmlite ", b"llvmlite 9", 1))


def open_to_all(path: Path, random: Random) -> None:
    path.chmod(0o666)


def of_another_user(path: Path, random: Random) -> None:
    os.chown(path, 12345, 12345)


def a_link(path: Path, random: Random) -> None:
    other = path.with_name("planted")
    path.rename(other)
    path.symlink_to(other)


def a_pipe(path: Path, random: Random) -> None:
    path.unlink()
    os.mkfifo(path)


DAMAGES = [flipped, flipped, cut, emptied, of_another_machine, open_to_all, a_link, a_pipe]
if os.geteuid() == 0:
    DAMAGES.append(of_another_user)


def damaged(folder: Path, random: Random) -> Verdict:
    """A damaged or foreign file is not used, and a good one is made in its place."""
    expected = right()
    del expected
    place = folder / "cache"
    copytree(warm(), place)
    for path in place.glob("*.code"):
        damage = random.choice(DAMAGES)
        damage(path, random)
    verdict = judged(damage.__name__, place)
    if verdict is not GOOD:
        return verdict
    about = path.lstat()
    whole = stat.S_ISREG(about.st_mode) and stat.S_IMODE(about.st_mode) == 0o600
    mine = about.st_uid == os.geteuid() and about.st_size > 1000
    return GOOD if whole and mine else Verdict(WRONG, f"{damage.__name__}: not made anew: {about}")


def open_folder(folder: Path) -> tuple[Path, dict[str, str]]:
    place = folder / "cache"
    place.mkdir()
    place.chmod(0o777)
    return place, {}


def foreign_folder(folder: Path) -> tuple[Path, dict[str, str]]:
    place = folder / "cache"
    copytree(warm(), place)
    if os.geteuid() == 0:
        os.chown(place, 12345, 12345)
    return place, {}


def linked_folder(folder: Path) -> tuple[Path, dict[str, str]]:
    (folder / "other").mkdir()
    (folder / "cache").symlink_to(folder / "other")
    return folder / "cache", {}


def a_file(folder: Path) -> tuple[Path, dict[str, str]]:
    (folder / "cache").write_text("a file")
    return folder / "cache", {}


def no_home(folder: Path) -> tuple[Path, dict[str, str]]:
    return Path(), {"DESAXE_CACHE_DIR": "", "HOME": "", "XDG_CACHE_HOME": "relative"}


def nowhere(folder: Path) -> tuple[Path, dict[str, str]]:
    return Path("/dev/null/cache"), {"TMPDIR": str(folder)}


def full_device(folder: Path) -> tuple[Path, dict[str, str]]:
    return Path("/proc/self/desaxe"), {}


ODD = [open_folder, foreign_folder, linked_folder, a_file, no_home, nowhere, full_device]


def odd_folder(folder: Path, random: Random) -> Verdict:
    kind = random.choice(ODD)
    right()
    place, environment = kind(folder)
    verdict = judged(kind.__name__, place, **environment)
    if verdict is GOOD and kind is open_folder and stat.S_IMODE(place.stat().st_mode) != 0o700:
        return Verdict(WRONG, "the folder stays open to all")
    return verdict


TRIALS = [
    Trial("a damaged or foreign file in the cache", damaged, 0, 60),
    Trial("an odd cache folder", odd_folder, 0, 28),
]
