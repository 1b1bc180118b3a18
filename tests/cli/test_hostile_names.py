"""A file's name never steers the terminal, whatever command it is given to."""

import ast
import contextlib
import os
from pathlib import Path

import pytest

import desaxe as dx
from desaxe.cli.command import main
from tests.effort import first

# Colours, the window's title, ends of lines, C1, another direction of writing; bytes that are no text.
HOSTILE = ("a\x1b[31mb\x1b]0;title\x07c\rd\x9b2Je\u202ef\ng", os.fsdecode(b"a\xff\x1b[2J"))
SCENE = """
outputs = ["V_C"]
[mechanism]
AB = 0.125
BC = 0.35
ec = [0.0, 0.05]
[motion]
theta = [0.0, 1.0, 2.0]
omega0 = 157.08
"""
# `{}` is the name, of a file that is there or not.
COMMANDS = """
scene {}.toml
scene {}
scene folder{}
scene empty{}.toml
run {}.toml
run {}
run empty{}.toml
explain {}.toml
explain {}
compile {}.toml -o press.py
compile {}.toml -o {}.py
compile {}.toml --to c -o {}
compile {}.toml --to c -o folder{}/press
compile {}.toml --to c -o folder{}/press --check
compile {}.toml -o {}.toml
explore {}.toml -o {}.html
explore {} -o {}.html
explore {}.toml -o {}.toml
sweep {}.toml --store {}.zarr
sweep {}.toml --store folder{}
sweep {}.toml --store {}.toml
sweep {}.toml --store {}.zarr --netcdf {}.txt
fit {}.csv --machine {}.toml over=ec
fit {} --machine {}
fit {}.toml --machine {}.toml over=ec
fit {}.csv --machine {}.toml over=ec -o {}.toml
derive --quantities {}.toml -o {}
derive --quantities {} -o own
derive --quantities own{}.toml -o {}
derive --quantities own{}.toml -o folder{}
derive --quantities own{}.toml -o package
derive --quantities own{}.toml -o folder{} --check
derive --quantities own{}.toml
derive --quantities {} {}
evaluate {}
evaluate a_C theta={}
run {} {}
{}
run --{}
doctor {}
"""


@pytest.fixture(params=first(1, HOSTILE), ids=ascii)
def name(request, tmp_path, monkeypatch):
    """Scenes, tables and folders of such a name, in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path(f"{request.param}.toml").write_text(SCENE)
    Path(f"empty{request.param}.toml").write_text("")
    Path(f"own{request.param}.toml").write_text('[quantities.zz]\nexpression = "2*a_C"\n')
    Path(f"{request.param}.csv").write_text("theta [deg], a_C [m/s2]\n1,2\nx,3\n")
    Path(f"folder{request.param}").mkdir()
    Path(f"folder{request.param}", f"{request.param}.txt").write_text("x")
    return request.param


def printed(text):
    """The text is one that a terminal only shows."""
    return all(character == "\n" or character.isprintable() for character in text)


@pytest.mark.parametrize("command", COMMANDS.strip().splitlines())
def test_no_command_prints_it_as_it_is(command, name, capfd):
    words = [word.replace("{}", name) for word in command.split()]
    with contextlib.suppress(SystemExit):
        main(words)
    out, err = capfd.readouterr()
    assert out or err
    assert printed(out), ascii(out)
    assert printed(err), ascii(err)
    assert name not in out + err


INPUTS = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0}
CALLS = {
    "scene": lambda name: dx.scene(f"empty{name}.toml"),
    "scene that is a folder": lambda name: dx.scene(f"folder{name}"),
    "run": lambda name: dx.scene(f"wrong{name}.toml"),
    "compile": lambda name: dx.compile(f"{name}.toml", f"{name}.py"),
    "compile over it": lambda name: dx.compile(f"{name}.toml", f"folder{name}/{name}", to="c"),
    "compile checked": lambda name: dx.compile(f"{name}.toml", f"folder{name}/press", to="c", check=True),
    "explore": lambda name: dx.explore(f"{name}.toml", f"{name}.toml"),
    "over_theta": lambda name: dx.over_theta.read(f"{name}.toml"),
    "over_theta of bytes": lambda name: dx.over_theta.read(f"{name}.bin"),
    "over_Y": lambda name: dx.over_Y.read(f"{name}.csv", Y="mm"),
    "fit": lambda name: dx.fit(f"{name}.csv", over=["ec"], **INPUTS),
    "fit of a scene": lambda name: dx.fit(f"{name}.toml", over=["ec"], **INPUTS),
    "a store": lambda name: dx.sweep("a_C", store=f"folder{name}", theta=[0.0, 1.0], **INPUTS),
    "a machine": lambda name: dx.Machine.read(f"absent{name}.toml"),
    "a machine's scene": lambda name: dx.Machine(**INPUTS).to_scene(f"folder{name}"),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_no_error_of_the_library_has_it_as_it_is(call, name):
    Path(f"wrong{name}.toml").write_text("outputs = 3\n")
    Path(f"{name}.bin").write_bytes(b"\xff\xfe")
    with pytest.raises((ValueError, OSError)) as raised:
        call(name)
    assert printed(str(raised.value)), ascii(str(raised.value))


def test_the_source_of_a_file_cannot_leave_its_comment(tmp_path, monkeypatch, capsys):
    """The name of the file of definitions stands in the docstrings of the package."""
    monkeypatch.chdir(tmp_path)
    source = Path('a"""\nimport os\n"""b\\.toml')
    source.write_text('[quantities.zz]\nexpression = "2*a_C"\n')
    assert main(["derive", "--quantities", str(source), "-o", "package"]) == 0
    for file in Path("package").glob("*.py"):
        assert "import os" not in ast.unparse(without_docstring(ast.parse(file.read_text()))), file


def without_docstring(tree):
    assert ast.get_docstring(tree)
    del tree.body[0]
    return tree
