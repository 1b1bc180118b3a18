"""Every C file that scenes give is clean under the flags of embedded projects, as C99 and as C++17."""

import pytest

import desaxe as dx
from tests.compiler.languages.tools import CPLUSPLUS, STRICT, run, tool
from tests.scenes.export import test_c, test_words
from tests.scenes.export.stress import scene
from tests.scenes.test_examples import EXAMPLES

WORDS = [
    "namespace",
    "new",
    "this",
    "gamma",
    "y1",
    "index",
    "stable",
    "status_of",
]  # of C++, of libm, of the file


def contents():
    """Name -> scene: the examples, the shapes that the tests of C and of words have, all inputs open."""
    examples = [path for path in EXAMPLES.glob("*.toml") if "outputs" in path.read_text(encoding="utf-8")]
    result = {path.stem: path for path in examples} | test_c.SCENES
    shapes = {name: {"quantities": {}, **more} for name, more in test_words.SCENES.items()}
    result |= {name: test_words.scene(**more) for name, more in shapes.items() if "over" not in name}
    result |= {f"open {branch}": scene(branch) for branch in (1, -1)}
    return result | {"words": test_words.scene(["a_C", *WORDS])}


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Each scene's source."""
    folder, files = tmp_path_factory.mktemp("flags"), []
    for number, content in enumerate(contents().values()):
        files.append(dx.compile(content, folder / f"{number}" / "press", to="c") / "press.c")
    return files


COMPILERS = (
    ("gcc", STRICT),
    ("clang", STRICT),
    ("g++", CPLUSPLUS),
    pytest.param(("clang++", CPLUSPLUS), marks=pytest.mark.thorough),
)


@pytest.mark.thorough
@pytest.mark.parametrize("build", COMPILERS, ids=lambda build: build[0])
def test_no_warning(build, sources):
    compiler, flags = build
    assert len(sources) > 15
    run(tool(compiler), *flags, "-fsyntax-only", *sources)
