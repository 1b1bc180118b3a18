"""Text of a scene is data in every file that is made of it, and nothing is written but where it is named."""

import ast
import json
import re
import shutil
import subprocess

import numpy as np
import pytest

import desaxe as dx
from tests.compiler.languages.tools import STRICT, imported, octave, run, tool

TITLES = {
    "ends of strings and comments": '"; alert(1) // */ \'\'\' """ ` \\ %} ]]> -- #endif ?>',
    "comments": "/* a /*/ b */* c \\* d *\\ e",
    "markup": "</script><script>alert(1)</script><img src=x onerror=alert(1)>&lt;",
    "lines": "a\nsystem('touch pwned')\n#include \"/etc/passwd\"\rimport os\u2028alert(1)\u2029x",
    "formulas": "=cmd|' /C calc'!A0",
    "TeX": "\\input{/etc/passwd} $\\write18{id}$ %",
    "places": "../../pwned",
    "templates": "${process.exit(3)} {0} %s @NAME@ {{x}}",
    "backslash": "x\\",
    "quote": 'x"',
}
LANGUAGES = {"numba": "k.py", "c": "k_c", "octave": "k_octave", "jax": "k_jax", "javascript": "k_js"}


def scene_of(title, **more):
    return dx.scene(
        {
            "title": title,
            "outputs": ["a_C", "zz"],
            "mechanism": {"ec": [0.0, 0.01], "AB": 0.125, "BC": 0.35},
            "motion": {"omega0": 157.08, "theta": {"start": 0, "stop": 6.0, "num": 5}},
            "quantities": {"zz": {"expression": "2*a_C", "unit": "m/s^2", "meaning": "twice"}},
            "check": [
                {
                    "title": title,
                    "source": title,
                    "at": {"theta": 1.0, "ec": 0.0},
                    "printed": {"a_C": "-1144 m/s2"},
                }
            ],
            "peak": [{"title": title, "quantity": "a_C", "over": {"ec": [0.0, 0.01]}}],
            **more,
        }
    )


def files_in(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())


def comments_alone(text, pattern):
    """A source text without its comments."""
    return re.sub(pattern, "", text, flags=re.S | re.M)


def compiled(title, folder):
    """The texts of all languages, by path."""
    for language, name in LANGUAGES.items():
        dx.compile(scene_of(title), folder / name, to=language)
    return {path.relative_to(folder): path.read_text() for path in files_in(folder)}


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return compiled("x", tmp_path_factory.mktemp("plain"))


@pytest.mark.thorough
@pytest.mark.parametrize("title", TITLES.values(), ids=TITLES)
def test_source_in_every_language(title, plain, tmp_path):
    result = compiled(title, tmp_path / "hostile")
    assert result.keys() == plain.keys()
    for path, text in result.items():
        other = plain[path]
        if path.suffix == ".py":  # the same statements: only docstrings differ
            assert without_docstrings(text) == without_docstrings(other)
        else:
            pattern = r"^\s*%[^\r\n\u2028\u2029]*$" if path.suffix == ".m" else r"/\*.*?\*/"
            assert comments_alone(text, pattern) == comments_alone(other, pattern), path
    assert {path.name for path in tmp_path.iterdir()} == {"hostile"}
    if shutil.which("gcc"):
        source = str(tmp_path / "hostile" / "k_c" / "k_c.c")
        subprocess.run(["gcc", *STRICT, "-fsyntax-only", source], check=True)
    if shutil.which("node"):
        (script,) = tmp_path.glob("hostile/k_js/*.js")
        subprocess.run(["node", "--check", str(script)], check=True)


def test_the_meaning_of_a_quantity_stays_in_its_comment(tmp_path):
    meaning = "work /* per // turn # ' ` % {"
    own = {"turned": {"expression": "a_C * sin(phi)", "meaning": meaning}}
    for language, name in LANGUAGES.items():
        dx.compile(scene_of("x", outputs=["turned"], quantities=own), tmp_path / name, to=language)
    run(tool("gcc"), *STRICT, "-fsyntax-only", tmp_path / "k_c" / "k_c.c")
    run(tool("node"), "--check", tmp_path / "k_js" / "k_js.js")
    (x,) = octave(tmp_path / "k_octave" / "k_octave.m", [np.array([1.0]), np.array([0.01])], 1)
    assert x[0] == pytest.approx(imported(tmp_path / "k.py").point(1.0, 0.01)[0], rel=1e-13)
    dx.undefine("turned")


def without_docstrings(text):
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef)) and ast.get_docstring(node) is not None:
            del node.body[0]
    return re.sub(r"Constant\(value='[^']*'\)", "", ast.dump(tree))


@pytest.mark.parametrize("title", [TITLES[k] for k in ("markup", "lines", "formulas", "TeX", "places")])
def test_pages_pictures_tables_and_the_terminal(title, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    picture = {"title": title, "file": "p.svg", "quantity": "a_C", "over": "theta"}
    scene = scene_of(title, picture=[{**picture, "at": {"ec": 0.0}}], results={"data": "r.csv"})
    scene.run()
    dx.explore(scene, "page.html")
    assert {path.name for path in tmp_path.iterdir()} >= {"p.svg", "r.csv", "page.html"}
    assert all("pwned" not in path.name for path in tmp_path.parent.rglob("pwned*"))
    page = (tmp_path / "page.html").read_text()
    (content,) = re.findall(r'<script[^>]*id="content"[^>]*>(.*?)</script>', page, re.S)
    assert title in json.loads(content).values()
    assert "<script>alert(1)" not in page
    assert "onerror=alert(1)>" not in re.sub(r"<script.*?</script>", "", page, flags=re.S)
    rows = np.genfromtxt(tmp_path / "r.csv", delimiter=",", skip_header=2)
    assert rows.shape[0] == 10
    for line in (tmp_path / "r.csv").read_text().splitlines():
        assert not line.startswith(("=", "@", "\t"))
    assert "<script" not in (tmp_path / "p.svg").read_text()


@pytest.mark.parametrize("title", ["\x1b[31mred", "a\x00b", "a\x07", "\x9b31m", "\u202egnp.exe"])
def test_control_characters_are_refused(title):
    with pytest.raises(ValueError, match="title"):
        scene_of(title)
