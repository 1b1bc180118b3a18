"""Writing is all or nothing: whatever stops it, the old files are there, and nothing else."""

import os
import shutil
from pathlib import Path

import pytest
from desaxe.derive.write import write
from desaxe.support import files

OLD = {"a.py": "a = 1\n", "b.py": "b = 1\n", "c.py": "c = 1\n", "stale.py": "stale = 1\n"}
NEW = {"a.py": "a = 2\n", "b.py": "b = 1\n", "c.py": "c = 2\n", "new.py": "new = 2\n"}
CHANGED = ["a.py", "c.py", "new.py", "stale.py"]
STOPS = [OSError("the disk is full"), KeyboardInterrupt(), SystemExit(1)]


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "generated"
    made.mkdir()
    for name, text in OLD.items():
        (made / name).write_bytes(text.encode())
    (made / "notes.txt").write_text("not ours")
    return made


def contents(folder):
    return {path.name: path.read_bytes().decode() for path in folder.iterdir()}


def test_the_new_files_are_there_and_the_stale_ones_gone(folder):
    assert write(NEW, folder) == CHANGED
    assert contents(folder) == NEW | {"notes.txt": "not ours"}


def test_an_unchanged_file_keeps_its_time(folder):
    os.utime(folder / "b.py", ns=(10**18, 10**18))
    write(NEW, folder)
    assert (folder / "b.py").stat().st_mtime_ns == 10**18


def test_writing_again_changes_nothing(folder):
    write(NEW, folder)
    for name in NEW:
        os.utime(folder / name, ns=(10**18, 10**18))
    assert write(NEW, folder) == []
    assert {path.stat().st_mtime_ns for path in folder.glob("*.py")} == {10**18}


def test_a_folder_is_made(tmp_path):
    write(NEW, tmp_path / "new" / "generated")
    assert contents(tmp_path / "new" / "generated") == NEW


def test_where_two_names_cannot_be_swapped_at_once_it_takes_two_steps(folder, monkeypatch):
    monkeypatch.setattr(files, "exchange", lambda one, other: False)
    assert write(NEW, folder) == CHANGED
    assert contents(folder) == NEW | {"notes.txt": "not ours"}
    assert list(folder.parent.iterdir()) == [folder]


def failing(function, stop, after):
    """The function, until it has been called `after` times; then it stops."""
    calls = []

    def wrapped(*args, **kwargs):
        calls.append(args)
        if len(calls) == after + 1:
            raise stop
        return function(*args, **kwargs)

    return wrapped


STEPS = {"linking": (shutil, "copytree", 1), "staging": (Path, "write_bytes", 3), "swapping": (files, "exchange", 1)}
MOMENTS = [(step, after) for step, (_, _, count) in STEPS.items() for after in range(count)]


@pytest.mark.parametrize("stop", STOPS, ids=repr)
@pytest.mark.parametrize(("step", "after"), MOMENTS)
def test_whatever_stops_it_the_old_files_are_there(folder, monkeypatch, stop, step, after):
    owner, name, _ = STEPS[step]
    before = contents(folder)
    monkeypatch.setattr(owner, name, failing(getattr(owner, name), stop, after))
    with pytest.raises(type(stop)):
        write(NEW, folder)
    monkeypatch.undo()
    assert contents(folder) == before
    assert list(folder.parent.iterdir()) == [folder]


def test_what_was_never_swapped_keeps_its_time(folder, monkeypatch):
    os.utime(folder / "c.py", ns=(10**18, 10**18))
    monkeypatch.setattr(files, "exchange", failing(files.exchange, OSError("no"), 0))
    with pytest.raises(OSError, match="no"):
        write(NEW, folder)
    assert (folder / "c.py").stat().st_mtime_ns == 10**18


def test_half_a_file_is_never_left(folder, monkeypatch):
    """The disk fills up in the middle of a file."""
    whole = Path.write_bytes

    def half(path, data):
        whole(path, data[: len(data) // 2])
        raise OSError("the disk is full")

    monkeypatch.setattr(Path, "write_bytes", half)
    before = contents(folder)
    with pytest.raises(OSError, match="the disk is full"):
        write(NEW, folder)
    assert contents(folder) == before
