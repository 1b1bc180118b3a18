"""Output files of a run: checked first, never over a foreign file, never at the cost of the report."""

import os
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.scenes.command import run_scene
from desaxe.scenes.parts import grid
from desaxe.scenes.scene import NotWrittenError
from tests.example_scenes import SMALL

TOML = """
outputs = ["V_C"]
[mechanism]
AB = 0.125
BC = 0.35
ec = [0.0, 0.05]
[motion]
theta = { start = 0, stop = "360 deg", num = 5 }
omega0 = 157.08
[[peak]]
quantity = "a_C"
[results]
data = "%s"
"""
PICTURE = '[[picture]]\nfile = "%s"\nquantity = "V_C"\nfamily = { ec = [0, 0.05] }\n'
FOREIGN = "years of work"


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def scene_file(data="out/a.csv", picture=None):
    """A scene on disk."""
    text = TOML % data + (PICTURE % picture if picture else "")
    Path("press.toml").write_text(text, encoding="utf-8")
    return "press.toml"


@pytest.fixture
def nothing_is_computed(monkeypatch):
    def fail(*_, **__):
        raise AssertionError("something was computed")

    monkeypatch.setattr("desaxe.scenes.parts.peaks.peak", fail)
    monkeypatch.setattr("desaxe.scenes.parts.grid.plan_of_grid", fail)


@pytest.mark.parametrize("foreign", ["a.csv", "a_peak_absmax_a_C.csv", "a.png"])
def test_another_file_stays_and_nothing_is_computed(foreign, nothing_is_computed, capsys):
    Path(foreign).write_text(FOREIGN)
    assert main(["run", scene_file("a.csv", "a.png")]) == 2
    out, err = capsys.readouterr()
    assert f"{foreign} exists and was not written by desaxe" in err
    assert out == ""
    assert sorted(os.listdir()) == sorted([foreign, "press.toml"])
    assert Path(foreign).read_text() == FOREIGN


def test_overwrite_replaces_it(tmp_path):
    Path("a.csv").write_text(FOREIGN)
    assert main(["run", scene_file("a.csv"), "--overwrite"]) == 0
    assert Path("a.csv").read_text().splitlines()[1].startswith("ec [m],theta [rad],V_C [m/s]")
    assert main(["run", scene_file("a.csv")]) == 0


@pytest.mark.parametrize(
    ("data", "picture"),
    [("a.csv", "a.png"), ("a.nc", "a.svg"), ("a.npz", "a.pdf"), ("a.xlsx", "a.png"), ("a.zarr", "a.svg")],
)
def test_a_rerun_replaces_its_own_outputs_wherever_they_were_copied_to(data, picture):
    """Under other names; what has lost its mark is left alone."""
    first = scene_file(data, picture)
    assert main(["run", first]) == 0
    for name in os.listdir():
        if name.startswith("a"):
            os.rename(name, f"b{name.removeprefix('a')}")
    again = scene_file(f"b{data[1:]}", f"b{picture[1:]}")
    assert main(["run", again]) == 0
    Path(f"b{picture[1:]}").write_bytes(Path(f"b{picture[1:]}").read_bytes().replace(b"desaxe", b"others"))
    assert main(["run", again]) == 2
    assert main(["run", again, "--overwrite"]) == 0


def test_a_table_without_its_comment_is_foreign_and_an_empty_file_is_free(capsys):
    assert main(["run", scene_file("a.csv")]) == 0
    first, *rest = Path("a.csv").read_text().splitlines(keepends=True)
    assert first.startswith("# desaxe ")
    Path("a.csv").write_text("".join(rest))
    assert main(["run", scene_file("a.csv")]) == 2
    assert Path("a.csv").read_text() == "".join(rest)
    Path("c.csv").touch()
    assert main(["run", scene_file("c.csv")]) == 0


def test_two_results_in_one_place_are_refused(nothing_is_computed, capsys):
    text = TOML % "a.csv" + PICTURE % "a.png" + PICTURE % "./a.png"
    Path("press.toml").write_text(text)
    assert main(["run", "press.toml"]) == 2
    assert "picture #2.file = 'a.png': picture #1.file is written there" in capsys.readouterr().err


def test_a_folder_a_file_for_a_folder_or_a_long_name_is_refused(nothing_is_computed, capsys):
    Path("a.csv").mkdir()
    Path("taken").touch()
    for data, words in [
        ("a.csv", "this is a folder"),
        ("taken/a.csv", "Not a directory"),
        (f"{'x' * 300}.csv", "File name too long"),
    ]:
        assert main(["run", scene_file(data)]) == 2
        assert words in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_refused(nothing_is_computed, capsys, monkeypatch):
    def closed(*_, **options):
        raise PermissionError(13, "Permission denied", "inner")

    monkeypatch.setattr("tempfile.TemporaryFile", closed)  # root may write everywhere
    assert main(["run", scene_file("out/a.csv")]) == 2
    assert f"{Path.cwd()}: Permission denied" in capsys.readouterr().err


def test_what_is_larger_than_the_disk_is_refused(nothing_is_computed, capsys, monkeypatch):
    class Usage:
        free = 30

    monkeypatch.setattr("shutil.disk_usage", lambda _: Usage)
    assert main(["run", scene_file("a.csv")]) == 2
    assert "it takes 40 bytes or more, 30 bytes are free" in capsys.readouterr().err


def test_the_report_is_not_lost_and_other_files_are_written(capsys, monkeypatch):
    """The disk is full for one file: the report is there, and the picture."""

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("desaxe.scenes.stores.files.table_of", full)
    assert main(["run", scene_file("a.csv", "a.png")]) == 2
    out, err = capsys.readouterr()
    assert "Largest magnitude of a_C" in out
    assert "Written\n  a.png" in out
    assert err == "desaxe: error: a.csv: not written: [Errno 28] No space left on device\n"
    assert sorted(os.listdir()) == ["a.png", "press.toml"]
    with pytest.raises(NotWrittenError, match=r"a\.csv: not written") as raised:
        dx.scene("press.toml").run()
    assert raised.value.result.dataset is not None
    assert raised.value.result.files == (Path("a.png"),)
    assert "Not written\n  a.csv" in str(raised.value.result)


def test_a_store_that_fails_costs_no_report(capsys, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "a.zarr/V_C/c/0/0")

    monkeypatch.setattr("desaxe.scenes.parts.grid.sweep_content", full)
    Path("press.toml").write_text((TOML % "x").replace('data = "x"', 'store = "a.zarr"'))
    assert main(["run", "press.toml"]) == 2
    out, err = capsys.readouterr()
    assert "Largest magnitude of a_C" in out
    assert "a.zarr: not written: No space left on device" in err


def test_a_folder_that_vanishes_is_made_again(monkeypatch):
    Path("out").mkdir()
    values = grid.plan_of_grid

    def vanish(*arguments):
        Path("out").rmdir()
        return values(*arguments)

    monkeypatch.setattr("desaxe.scenes.parts.grid.plan_of_grid", vanish)
    assert main(["run", scene_file("out/a.csv")]) == 0
    assert Path("out/a.csv").is_file()


def test_a_file_that_appears_meanwhile_stays(capsys, monkeypatch):
    values = grid.plan_of_grid

    def appear(*arguments):
        Path("a.csv").write_text(FOREIGN)
        return values(*arguments)

    monkeypatch.setattr("desaxe.scenes.parts.grid.plan_of_grid", appear)
    assert main(["run", scene_file("a.csv")]) == 2
    assert "Largest magnitude" in capsys.readouterr().out
    assert Path("a.csv").read_text() == FOREIGN


def test_files_are_written_though_nobody_reads_the_report(monkeypatch):
    def closed(*_, **options):
        raise BrokenPipeError(32, "Broken pipe")

    scene_file("a.csv")
    monkeypatch.setattr("desaxe.scenes.command.print", closed, raising=False)
    with pytest.raises(BrokenPipeError):
        run_scene("press.toml", overwrite=False)
    assert Path("a.csv").is_file()


@pytest.mark.parametrize(
    ("make", "name", "file"),
    [
        (dx.compile, "kernels.py", "kernels.py"),
        (dx.explore, "page.html", "page.html"),
        (partial(dx.compile, to="c"), "press", "press/press.h"),
        (partial(dx.compile, to="c"), "press", "press/press.c"),
        (partial(dx.compile, to="octave"), "press.m", "press.m"),
        (partial(dx.compile, to="jax"), "press_jax.py", "press_jax.py"),
        (partial(dx.compile, to="javascript"), "press.js", "press.d.ts"),
    ],
    ids=lambda given: given if isinstance(given, str) else "",
)
def test_what_was_generated_and_edited_is_left_alone(make, name, file):
    """Also where another machine wrote it; checkouts may change ends of lines."""
    scene = dx.scene({**SMALL, "peak": []})
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).write_text(FOREIGN)
    with pytest.raises(FileExistsError, match="exists and was not written by desaxe"):
        make(scene, name)
    make(scene, name, overwrite=True)
    first = Path(file).read_bytes()
    Path(file).write_bytes(first.replace(b"\n", b"\r\n"))
    make(scene, name)
    assert Path(file).read_bytes() == first
    for place in (len(first) // 50, len(first) // 2, len(first) - 3):
        edited = first[:place] + b"0" + first[place:]
        Path(file).write_bytes(edited)
        with pytest.raises(FileExistsError, match="or was edited since; use --overwrite"):
            make(scene, name)
        assert Path(file).read_bytes() == edited
    make(scene, name, overwrite=True)
    assert Path(file).read_bytes() == first


PRESS = dx.Machine(ec=0.01, AB=0.125, BC=0.35, omega0=157.0)
LOADED = PRESS.replace(F_Y=dx.over_theta(np.linspace(0.0, 6.0, 40), np.linspace(0.0, 9.0, 40), kind="linear"))


def _picture(path, overwrite):
    dx.plot.save(PRESS.plot("a_C"), path, dpi=20, overwrite=overwrite)


@cache
def _movie():
    return PRESS.plot.animate("a_C", frames=2)


def _animation(path, overwrite):
    dx.plot.save(_movie(), path, dpi=20, overwrite=overwrite)


def _answer(path, overwrite):
    words = ["evaluate", "a_C", "theta=0,1", *["ec=0", "AB=0.1", "BC=0.3", "omega0=1"], "-o", path]
    if main([*words, *(["--overwrite"] if overwrite else [])]):
        raise FileExistsError


ROADS = {
    **dict.fromkeys(["a.png", "a.svg", "a.pdf", "a.eps"], _picture),
    **dict.fromkeys(["a.gif", "a.html"], _animation),
    **dict.fromkeys(["a.csv", "a.json"], _answer),
    "a.toml": lambda path, overwrite: PRESS.to_scene(path, overwrite=overwrite),
    "b_F_Y.csv": lambda path, overwrite: LOADED.to_scene("b.toml", overwrite=overwrite),
    "a.xlsx": lambda path, overwrite: dx.to_excel(
        PRESS.evaluate(["Y"], theta=1.0), path, overwrite=overwrite
    ),
}


@pytest.mark.parametrize("name", ROADS)
def test_every_output_bears_a_mark_and_no_other_file_is_lost(name):
    """A measurement or a hand-written scene of the name stays; what was written is replaced."""
    Path(name).write_text(FOREIGN)
    with pytest.raises(FileExistsError):
        ROADS[name](name, overwrite=False)
    assert Path(name).read_text() == FOREIGN
    assert sorted(os.listdir()) == [name]
    ROADS[name](name, overwrite=True)
    ROADS[name](name, overwrite=False)
    if name != "a.xlsx":  # whose parts are compressed
        Path(name).write_bytes(Path(name).read_bytes().replace(b"desaxe", b"others"))
        with pytest.raises(FileExistsError):
            ROADS[name](name, overwrite=False)


def test_a_scene_that_was_edited_is_not_replaced(tmp_path):
    PRESS.to_scene("a.toml")
    Path("a.toml").write_text(Path("a.toml").read_text().replace("125", "126"))
    with pytest.raises(FileExistsError, match=r"a\.toml exists and was not written by desaxe, or was edited"):
        PRESS.to_scene("a.toml")
    assert dx.Machine.read("a.toml")["AB"] == 0.126
