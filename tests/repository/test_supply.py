"""Supply chain: nothing is fetched or run from outside, and builds give the same bytes each time."""

import ast
import hashlib
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from tests.repository.test_wheel import BUILD, copy_of_the_tree

ROOT = Path(__file__).resolve().parents[2]
# Every place that runs a text as code; what it runs was written by our compiler from its own Program, or in
# modules of numba, which unroll loops over tuples, is made of their constant lines.
RUNS_TEXT = {
    "generated/_helpers.py",
    "src/desaxe/compiler/languages/numba/sources.py",
    "src/desaxe/simulation/loops/torque.py",
    "src/desaxe/runtime/native_calls.py",
    "src/desaxe/compiler/languages/arrays.py",
    "src/desaxe/compiler/languages/python.py",
}
UNTRUSTED_READERS = {"pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}


def trees():
    for room in ("src", "derive", "generated"):
        for path in sorted((ROOT / room).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def test_only_known_places_run_text_as_code():
    result = {
        name
        for name, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("exec", "eval")
    }
    assert result == RUNS_TEXT


def test_nothing_is_unpickled():
    imported = {
        (name, module)
        for name, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for module in [getattr(node, "module", None) or "", *(alias.name for alias in node.names)]
    }
    assert not {pair for pair in imported if pair[1].partition(".")[0] in UNTRUSTED_READERS}


def test_two_wheels_have_the_same_bytes(tmp_path):
    digests = set()
    for name in ("one", "two"):
        tree = tmp_path / name
        tree.mkdir()
        copy_of_the_tree(tree)
        subprocess.run([sys.executable, "-c", BUILD], cwd=tree, check=True, capture_output=True)
        (wheel,) = (tree / "wheel").glob("*.whl")
        digests.add(hashlib.sha256(wheel.read_bytes()).hexdigest())
    assert len(digests) == 1


def test_every_dependency_has_its_licence_listed():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    own = [*project["dependencies"]]
    for extra in re.search(r"\[(.*)\]", extras["all"][0])[1].split(","):
        own += extras[extra]
    names = {re.match(r"[\w-]+", requirement)[0] for requirement in own} - {"desaxe"}
    page = (ROOT / "docs" / "security.md").read_text("utf-8")
    listed = {name for row in re.findall(r"^\| ([\w, -]+) \|", page, re.M) for name in row.split(", ")}
    assert not names - listed
