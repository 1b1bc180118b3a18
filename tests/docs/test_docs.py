"""The documentation: every block of code runs, what it shows is true, the site builds without a warning."""

import ast
import inspect
import math
import os
import re
import shlex
import subprocess
import sys
from importlib import import_module
from importlib.metadata import metadata
from pathlib import Path

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r'^```(python|console|toml title="(?P<file>[\w.]+)")\n(?P<text>.*?)^```', re.S | re.M)
SHOWN = re.compile(r"^(?P<code>\S.*?) +# = (?P<text>.*)$", re.M)
PRINTED = re.compile(r"^print\((?P<code>.*)\)\n(?P<text>(?:# .*\n)+)", re.M)
PAGES = sorted(
    path.relative_to(ROOT).as_posix() for path in [*(ROOT / "docs").glob("*.md"), ROOT / "README.md"]
)
WITH_BLOCKS = [page for page in PAGES if BLOCK.search((ROOT / page).read_text(encoding="utf-8"))]


# One starts a cluster, the others compile much.
SLOW = ["derivation", "design", "forces", "howto", "languages", "loads", "machine", "pictures", "scale"]
ONCE = [pytest.param(p, marks=pytest.mark.thorough if Path(p).stem in SLOW else ()) for p in WITH_BLOCKS]


@pytest.mark.parametrize("page", ONCE)
def test_its_code_runs(page, tmp_path, monkeypatch, capsys):
    """In the order of the page, as one session; what it writes goes elsewhere."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    text, scope = (ROOT / page).read_text(encoding="utf-8"), {}
    known = set(sys.modules)
    for block in BLOCK.finditer(text):
        if block[1] == "python":
            run_python(block["text"], scope, page, text.count("\n", 0, block.start("text")))
        elif block["file"]:
            (tmp_path / block["file"]).write_text(block["text"], encoding="utf-8")
        else:
            run_console(block["text"], capsys)
    for name in set(sys.modules) - known:  # modules that the page has written
        if str(tmp_path) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def run_python(text, scope, page, line):
    """A block; then each `code  # = text` in it, and comments under a `print`, must be true."""
    exec(compile("\n" * line + text, page, "exec"), scope)
    for shown in SHOWN.finditer(text):
        value = eval(shown["code"], scope)
        assert looks_like(value, shown["text"]), (page, shown[0], value)
    for printed in PRINTED.finditer(text):
        words = re.sub(r"^# ", "", printed["text"], flags=re.M).split()
        assert str(eval(printed["code"], scope)).split() == words, (page, printed[0])


def looks_like(value, text):
    """True if a value agrees with the printed text, numbers to the printed digits."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    if isinstance(value, (tuple, list)):
        expected = ast.literal_eval(text)
        return len(value) == len(expected) and all(
            looks_like(v, repr(w)) for v, w in zip(value, expected, strict=True)
        )
    if isinstance(value, float) and re.fullmatch(r"-?[\d.]+(e-?\d+)?", text):
        digits = len(re.sub(r"^-?0*\.?0*|e.*|\.", "", text))
        return float(f"{value:.{digits}g}") == float(text)
    return str(value) == text or repr(value) == text


def test_the_check_sees_an_error():
    assert looks_like(0.25298698, "0.253")
    assert not looks_like(0.25298698, "0.2531")
    assert looks_like((1, 2.0004), "(1, 2.0)")
    assert not looks_like((1, 2.0004), "(1, 2.1)")
    assert not looks_like("rocker", "'crank'")


def test_the_check_sees_what_is_not_printed():
    run_python('print("a  b")\n# a\n# b\n', {}, "page", 0)
    with pytest.raises(AssertionError):
        run_python('print("a b")\n# a c\n', {}, "page", 0)


def run_console(text, capsys):
    """Every line: a command of ours, or an installation of extras that there are."""
    for line in text.splitlines():
        words = shlex.split(line, comments=True)
        if words[:4] == ["python", "-m", "pip", "install"]:
            extras = set(re.search(r"\[(.*)\]", words[-1])[1].split(","))
            assert extras <= set(metadata("desaxe").get_all("Provides-Extra"))
            continue
        assert words[0] == "desaxe", line
        assert main(words[1:]) == 0, line
        assert capsys.readouterr().out, line


@pytest.mark.parametrize(("margin", "digits"), [(1e-4, 10), (1e-9, 7)])
def test_the_digits_of_the_textbook_are_those_of_the_readme(margin, digits):
    """The worst of 400 angles about the change point, in doubles and at 50 digits."""
    AB, BC, omega = 0.125, 0.35, 157.08
    ec = BC - AB - margin

    def textbook(number, sin, cos, sqrt, theta):
        u, c = number(ec) + number(AB) * sin(theta), cos(theta)
        height, pin = sqrt(number(BC) ** 2 - u * u), number(AB) * c
        bend = (pin * pin - number(AB) * u * sin(theta)) / height + (u * pin) ** 2 / height**3
        return -(number(omega) ** 2) * (pin + bend)

    worst, promised = 0.0, 0.0
    for k in range(-200, 200):
        theta = math.pi / 2 + k * 1e-3 * math.sqrt(margin / 1e-4)
        with mpmath.workdps(50):
            truth = textbook(mpmath.mpf, mpmath.sin, mpmath.cos, mpmath.sqrt, mpmath.mpf(theta))
            plain = textbook(float, math.sin, math.cos, math.sqrt, theta)
            worst = max(worst, float(abs(plain / truth - 1)))
            ours = dx.evaluate("a_C", theta=theta, ec=ec, AB=AB, BC=BC, omega0=omega)
            promised = max(promised, float(abs(ours / truth - 1)))
    assert int(-math.log10(worst)) == digits
    assert promised < 1e-13
    assert f"{digits} " in (ROOT / "README.md").read_text(encoding="utf-8")


# A page is a session: names are bound anew, and the reader's own functions have no annotations.
TYPES = (
    "--allow-redefinition-new", "--local-partial-types", "--allow-untyped-defs", "--allow-untyped-calls",
    "--disable-error-code=import-not-found", "--disable-error-code=import-untyped",
)  # fmt: skip
ANSWERS = """
from typing import Any, assert_type

import numpy as np
from numpy.typing import NDArray

import desaxe as dx

lengths = {"ec": 0.01, "AB": 0.125, "BC": 0.35}
Floats = NDArray[np.float64]
angles: Floats = np.linspace(0.0, 1.0)
assert_type(dx.evaluate("Y", theta=1.0, ec=0.01, AB=0.125, BC=0.35), float)
assert_type(dx.evaluate(["Y", "V_C"], theta=1.0, branch=-1), dict[str, float])
assert_type(dx.evaluate("Y", theta=angles, ec="10 mm"), Floats)
assert_type(dx.evaluate(["Y"], theta=angles), dict[str, Floats])
assert_type(dx.evaluate("Y", theta=1.0, **lengths), Any)
dx.peak("a_C", omega0=150, **lengths)["value"]
"""


@pytest.mark.thorough
def test_its_code_has_types(tmp_path):
    """mypy --strict finds nothing in the code of the pages, and knows the types of answers."""
    for page in WITH_BLOCKS:
        blocks = BLOCK.finditer((ROOT / page).read_text(encoding="utf-8"))
        code = "\n".join(block["text"] for block in blocks if block[1] == "python")
        (tmp_path / f"page_{Path(page).stem.replace('-', '_')}.py").write_text(code, encoding="utf-8")
    (tmp_path / "page_types.py").write_text(ANSWERS, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", *TYPES]
    files = sorted(tmp_path.glob("*.py"))
    done = subprocess.run([*command, *files], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_every_block_that_could_run_does():
    """The kinds of blocks that are left are for reading."""
    left = {}
    for page in PAGES:
        text = BLOCK.sub("", (ROOT / page).read_text(encoding="utf-8"))
        left[page] = set(re.findall(r"^```(\w+)$", text, re.M))
    assert set().union(*left.values()) <= {"text", "matlab", "c", "py", "math"}, left
    expected = (
        "index", "howto", "design", "forces", "pictures", "choose", "coming-from", "promise", "scene",
        "quantities", "api",
    )  # fmt: skip
    assert {"README.md", *(f"docs/{name}.md" for name in expected)} <= set(WITH_BLOCKS)


WITH_TABLES = [page for page in PAGES if "<!-- table: " in (ROOT / page).read_text(encoding="utf-8")]


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=pytest.mark.thorough if Path(p).stem in SLOW else ()) for p in WITH_TABLES],
)
def test_the_tables_of_a_page_are_fresh(page, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs" / "_site")
    reference, text = import_module("reference"), (ROOT / page).read_text(encoding="utf-8")
    assert reference.with_tables(text) == text, "run `python docs/_site/reference.py`"
    stale = re.sub(r"(<!-- table: .*-->\n\n).", r"\1?", text)
    assert stale != text
    assert reference.with_tables(stale) == text


def test_every_table_stands_in_a_page(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs" / "_site")
    reference = import_module("reference")
    texts = [(ROOT / page).read_text(encoding="utf-8") for page in WITH_TABLES]
    assert {mark[1] for text in texts for mark in reference.TABLE.finditer(text)} == set(reference.WRITTEN)


def test_files_that_pages_name_exist():
    """A path in code font is that of a file of the repository, or its end."""
    files = [
        path.as_posix()
        for room in ("src", "derive", "tests", "docs", "benchmarks")
        for path in (ROOT / room).rglob("*.*")
    ]
    missing = [
        f"{page}: {path}"
        for page in ("docs/development.md", "CONTRIBUTING.md", "README.md", "docs/derivation.md")
        for path in re.findall(r"`([\w./-]+/[\w.-]+\.(?:py|txt|json|ll))`", (ROOT / page).read_text("utf-8"))
        if not any(file.endswith(f"/{path}") for file in files) and not (ROOT / path).exists()
    ]
    assert missing == []


@pytest.mark.thorough
def test_the_site(tmp_path):
    """Built as strictly as there is; what is generated stands in it, and links lead somewhere."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    plain = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=plain, check=False)
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    pages = {path.parent.name: path.read_text(encoding="utf-8") for path in tmp_path.rglob("index.html")}
    assert {Path(page).stem for page in PAGES if page.startswith("docs/")} - {"index"} <= set(pages)
    assert not [name for name, text in pages.items() if "<!-- desaxe:" in text]
    assert pages["derivation"].count('class="equation"') > 25
    assert all(f'id="desaxe{name.lower()}"' in pages["api"] for name in dx.__all__)
    assert all(f'id="desaxeplot{name.lower()}"' in pages["api"] for name in dx.plot.__all__)
    assert "m_slider" in pages["scene"]
    assert broken_links(tmp_path) == []


def broken_links(site):
    """Links to what is not in the site; those out of it are let be."""
    broken = []
    for page in site.rglob("index.html"):
        links = re.findall(r'(?:href|src)="([^"#?]+)', page.read_text(encoding="utf-8"))
        local = [link for link in links if not re.match(r"[a-z]+:|//|/", link)]
        broken += [(page.parent.name, link) for link in local if not (page.parent / link).exists()]
    return broken


def test_every_call_with_loads_is_in_their_table(monkeypatch):
    """Every public call that has loads among its inputs."""
    monkeypatch.syspath_prepend(ROOT / "docs" / "_site")
    loads = import_module("loads")
    message = {call.partition("(")[0] for call in loads.CALLS}
    with_inputs = set()
    for name in set(dx.__all__) - {"Machine", "define", "plot", "LoadWarning", "UnitWarning"}:
        known = inspect.signature(getattr(dx, name)).parameters
        kinds = {parameter.kind for parameter in known.values()}
        if "F_Y" in known or inspect.Parameter.VAR_KEYWORD in kinds:
            with_inputs.add(name)
    assert with_inputs <= message


@pytest.mark.parametrize(("call", "kinds"), [("evaluate", 7), ("peak", 7), ("function", 1)])
def test_the_table_of_loads_says_what_happens(call, kinds, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs" / "_site")
    loads = import_module("loads")
    assert sum(loads.takes(call, load) for load in loads.KINDS.values()) == kinds
