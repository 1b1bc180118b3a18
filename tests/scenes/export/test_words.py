"""Every word of a language, and of what is written in it, as the name of a quantity and of a file."""

import builtins
import keyword
import random
import re
import symtable
import sys

import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.languages.words import words_of
from desaxe.compiler.program import RESERVED  # of expressions, whatever the language
from desaxe.mechanism import own
from desaxe.mechanism.catalogue import has
from desaxe.scenes.export.compile import generated
from tests.compiler.languages.tools import (
    array_values,
    es_module,
    imported,
    jax_in_doubles,
    library,
    node,
    octave,
    point_values,
    run,
    tool,
)
from tests.effort import cases

THETA, SIZES = np.array([0.5, 2.0]), {"ec": 0.01, "AB": 0.125, "BC": 0.35}
LOADED = {"masses": {"m_slider": 1.0}, "outputs": ["a_C", "T_in", "T_in_wrt_theta"]}
RANGE = {"omega0": 157.08, "theta": {"start": "0 deg", "stop": "361 deg", "num": 722}}
MIXED = "exp(phi) * log(abs(phi) + 1)**1.3 + hypot(phi, 2) + atan2(phi, 2) + tan(theta) * max(phi, cos(phi))"
LOADED_OVER = {**LOADED, "loads": {"F_Y": {"over_theta": [[0.0, 0], [1.5, -4], [3.0, 4]]}}}
SCENES = {  # the parts that a module may have
    "lists": {},
    "ranges": {"motion": {**RANGE, "alpha": [0.0, 1.0, 5.0]}},
    "two axes": {"mechanism": {**SIZES, "ec": [0.0, 0.01]}},
    "fixed": {"motion": {"omega0": 1.0, "theta": 1.0}},
    "state": {"motion": {"omega": [0.0, 3.0], "alpha": 1.0, "theta": [0.0, 1.0]}},
    "twice the digits": {"accuracy": "extended"},
    "reduction": {"reduce": {"theta": ["absmax", "mean", "rms", "min"]}},
    "peaks": {"peak": [{"quantity": "a_C", "over": {"ec": {"start": 0, "stop": "33 mm", "num": 23}}}]},
    "friction": {**LOADED, "loads": {"mu": 0.1, "F_Y": -5.0}},
    "load over theta": LOADED_OVER,
    "load over Y": {**LOADED, "loads": {"F_Y": {"over_Y": [[0.2, 0], [0.3, -4], [0.4, 4]]}}},
    "functions": {"outputs": ["mixed", "mixed_wrt_ec"], "quantities": {"mixed": {"expression": MIXED}}},
}


def scene(outputs=("a_C",), **more):
    return dx.scene(
        {
            "outputs": list(outputs),
            "mechanism": SIZES,
            "motion": {"omega0": 157.08, "theta": THETA.tolist()},
            "quantities": {name: {"expression": "2*a_C"} for name in outputs if not has(name)},
            **more,
        }
    )


@pytest.fixture(autouse=True)
def nothing_defined():
    """Scenes leave their quantities behind."""
    before = own.definitions()
    yield
    own.change(lambda _: before)


def names(words):
    """The words that can be names of quantities; others are refused by name."""
    result = []
    for word in words:
        try:
            result.append(dx.define(word, "2*a_C"))
        except ValueError:
            with pytest.raises(ValueError, match=f"'{word}'"):
                dx.define(word, "2*a_C")
        else:
            dx.undefine(word)
    return result


def written(to, place):
    """The identifiers in all that is written in a language."""
    result = set()
    for more in SCENES.values():
        if to == "jax" and "accuracy" in more:
            continue
        texts = generated(scene(**more), place / VALUES[to][1], to).texts
        result |= {word for text in texts.values() for word in re.findall(r"\b[A-Za-z]\w*", text)}
    return result


def spoken(to):
    """The words of the language itself."""
    if to in ("numba", "jax"):
        module = np if to == "numba" else pytest.importorskip("jax.numpy")
        return {*keyword.kwlist, *keyword.softkwlist, *dir(builtins), *dir(module)}
    if to == "c":
        text = run(tool("gcc"), "-dM", "-E", "-include", "math.h", "-include", "stdint.h", "-xc", "/dev/null")
        return set(re.findall(r"#define ([A-Za-z]\w*)", text))
    if to == "octave":
        code = 'a = [iskeyword(); __builtins__(); __list_functions__()]; printf("%s\\n", a{:});'
        return set(run(tool("octave-cli"), "--norc", "--quiet", "--eval", code).split())
    code = "console.log(Object.getOwnPropertyNames(globalThis).join(' '))"
    return set(run(node(), "-e", code).split())


def drawn(to, place, few, refused):
    """Words that are not refused by a table: some, all of them by DESAXE_THOROUGH=all."""
    result = sorted({*words_of(to).lines, *written(to, place), *spoken(to)} - refused)
    result = [word for word in result if re.fullmatch(r"(?!t\d)[A-Za-z]\w{0,47}", word, re.ASCII)]
    return random.Random(27).sample(result, min(len(result), cases(few, 150, len(result))))


def values_in_numba(place, words):
    """By all that a module has; functions of one output as they stand, since each is compiled apart."""
    made = imported(place)
    result = made.run()
    for k, theta in enumerate(THETA):
        point = dict(zip(made.OUTPUTS, made.point(theta), strict=True))
        for word in words:
            assert getattr(made, word).py_func(theta) == pytest.approx(result[word][k], rel=1e-12)
            assert point[word] == pytest.approx(result[word][k], rel=1e-12)
    assert getattr(made, words[-1])(1.0) == pytest.approx(made.evaluate([1.0])[words[-1]][0], rel=1e-12)
    return result


def values_in_jax(place, words):
    with jax_in_doubles():
        made = imported(place)
        result = made.evaluate(theta=THETA)
        ones = [getattr(made, word)(THETA) for word in words[:9]]
        np.testing.assert_array_equal(ones, [result["a_C"] * 2] * len(ones))
        return result


def values_in_javascript(place, words):
    result, *ones = es_module(
        place, [["evaluate", {"theta": THETA.tolist()}], *([w, THETA[0]] for w in words)]
    )
    assert ones == [result[word][0] for word in words]
    return result


def values_in_c(place, words):
    result = array_values(library(place), "press", [THETA], len(words) + 1)
    return dict(zip(["a_C", *words], result, strict=True))


def values_in_octave(place, words):
    return dict(zip(["a_C", *words], octave(place, [THETA], len(words) + 1), strict=True))


VALUES = {
    "numba": (values_in_numba, "press.py"),
    "jax": (values_in_jax, "press.py"),
    "javascript": (values_in_javascript, "press.js"),
    "c": (values_in_c, "press.c"),
    "octave": (values_in_octave, "press.m"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("to", VALUES)
def test_words_as_quantities(to, tmp_path):
    """All words that are taken, in one module."""
    values, file = VALUES[to]
    refused = words_of(to).outputs
    for word in names(sorted(refused)):
        with pytest.raises(ValueError, match=f"outputs: '{word}': a word of the module's language"):
            dx.compile(scene([word]), tmp_path / file, to=to)
    good = names(drawn(to, tmp_path, 30, refused))
    try:
        dx.compile(scene(["a_C", *good]), tmp_path / file, to=to)
    except ValueError as error:  # names that this module has for itself
        taken = re.findall(r"'(\w+)'", str(error).partition(": a word")[0])
        assert to == "numba"
        assert taken
        good = [word for word in good if word not in taken]
        dx.compile(scene(["a_C", *good]), tmp_path / file, to=to)
    assert len(good) > 12
    result = values(tmp_path / file, good)
    for word in good:
        np.testing.assert_allclose(result[word], 2.0 * np.asarray(result["a_C"]), rtol=1e-15)


@pytest.mark.parametrize("to", VALUES)
def test_a_quantity_is_not_called_as_the_table_of_a_load(to, tmp_path):
    made = scene(["a_C", "F_Y_x", "T_in"], **{n: v for n, v in LOADED_OVER.items() if n != "outputs"})
    place = tmp_path / VALUES[to][1]
    if to in ("c", "octave"):  # where outputs have places, not names
        dx.compile(made, place, to=to)
        result = VALUES[to][0](place, ["F_Y_x", "T_in"])
        np.testing.assert_allclose(result["F_Y_x"], 2.0 * np.asarray(result["a_C"]), rtol=1e-15)
    else:
        with pytest.raises(ValueError, match="outputs: 'F_Y_x'"):
            dx.compile(made, place, to=to)


@pytest.mark.parametrize("to", ["numba", "jax"])
def test_the_table_has_all_that_a_module_imports_and_calls(to, tmp_path):
    """Under any scene; what a numba module defines besides is looked at in its text."""
    for name, more in SCENES.items():
        if to == "jax" and "accuracy" in more:
            continue
        (text,) = generated(scene(**more), tmp_path / "press.py", to).texts.values()
        table = symtable.symtable(text, "press", "exec")
        symbols = [symbol for scope in scopes(table) for symbol in scope.get_symbols()]
        local = {
            symbol.get_name()
            for symbol in table.get_symbols()
            if symbol.is_assigned() or symbol.is_namespace()
        }
        used = {s.get_name() for s in symbols if s.is_global() or s.is_imported()}
        own = (
            local if to == "numba" else {n for n in local if n[0] == "_"} | set(more.get("outputs", ["a_C"]))
        )
        assert used - own <= words_of(to).outputs | RESERVED, name


def scopes(table):
    return [table, *(scope for child in table.get_children() for scope in scopes(child))]


# ---- files -----------------------------------------------------------------------------------------

HERE = 0.5
PYTHON = """
import sys
sys.path.insert(0, "")
for name in {words}:
    print(float(__import__(name).evaluate(theta=0.5)["a_C"]))
"""
OCTAVE = """
for word = {words} addpath(word{1}); printf("%.17g\\n", feval(word{1}, 0.5)); rmpath(word{1}); end
"""


def by_python(folder, words):
    """In the folder where Python looks first."""
    return run(sys.executable, "-P", "-c", PYTHON.replace("{words}", repr(words)), cwd=folder)


def by_octave(folder, words):
    """Each from a folder of its own: in one they would be called by each other."""
    for word in words:
        (folder / word).mkdir()
        (folder / f"{word}.m").rename(folder / word / f"{word}.m")
    texts = ", ".join(f'"{word}"' for word in words)
    code = OCTAVE.replace("{words}", "{" + texts + "}")
    return run(tool("octave-cli"), "--norc", "--quiet", "--eval", code, cwd=folder)


def by_c(folder, words):
    """In the folder where headers are looked for first."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CPATH", str(folder))
        loaded = [library(folder / f"{word}.c") for word in words[:3]]
    result = [point_values(one, word, [HERE], 1)[1][0] for one, word in zip(loaded, words, strict=False)]
    return "\n".join(map(repr, result))


FILES = {
    "numba": (by_python, ".py"),
    "jax": (by_python, ".py"),
    "octave": (by_octave, ".m"),
    "c": (by_c, ".c"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("to", FILES)
def test_words_as_files(to, tmp_path):
    read, suffix = FILES[to]
    refused = words_of(to).modules
    for word in sorted(refused):
        with pytest.raises(ValueError, match=rf"{word}{suffix}: ('{word}' cannot be|Python cannot import)"):
            dx.compile(scene(), tmp_path / f"{word}{suffix}", to=to)
    script = set(re.findall(r"\w+", OCTAVE + PYTHON))
    own = set(spoken(to)) if to == "octave" else set()  # to a file of that name Octave may prefer its own
    count = 4 if to == "numba" else 12  # of which each takes seconds to compile
    words = drawn(to, tmp_path, count, refused | own | script | {*keyword.kwlist, *keyword.softkwlist})
    for word in words:
        dx.compile(scene(), tmp_path / f"{word}{suffix}", to=to)
    expected = dx.evaluate("a_C", theta=HERE, **SIZES, omega0=157.08)
    result = [float(line) for line in read(tmp_path, words).split()]
    np.testing.assert_allclose(result, expected, rtol=1e-6 if to == "jax" else 1e-13)  # float32 there
    assert len(result) >= 3
