"""Loops over the nodes of panels run in the lanes of vectors: LLVM's text of them has packed arithmetic."""

import re

import pytest

from desaxe.compiler.builder import module_text
from desaxe.compiler.languages.numba.module import numba_parts
from desaxe.runtime.native import compiled_text
from desaxe.runtime.native.modules import native, path_of
from desaxe.simulation.energy.loops import compiled as energy

PIECES = {
    "add_factors": ("0.5, 0.1, 1.0, row, other, rows[0], rows[1], rows[2], rows[3]", {"div", "sqrt", "mul"}),
    "add_lanes_of": ("row, other, rows[0], rows[1], 0.1, rows[2]", {"mul", "add"}),
}


def vectors_of(text, monkeypatch):
    """The operations on vectors of doubles in a text's optimised module."""
    found, own = [], compiled_text.optimised
    monkeypatch.setattr(compiled_text, "optimised", lambda *a: found.append(own(*a)) or found[0])
    compiled_text.compile_text(text, "a test", {})
    written = str(found[0])
    names = re.findall(r"= f(\w+) (?:[a-z]+ )*<\d+ x double>", written)
    return {*names, *re.findall(r"call (?:[a-z]+ )*<\d+ x double> @llvm\.(\w+)\.v", written)}


def text_of(name, given, parts, files, tail):
    """A text whose function only calls one of these."""
    call = f"def looped(row, other, rows):\n    {name}({given})\n"
    row, rows = "types.float64[::1]", "types.float64[:, ::1]"
    signature = f"signature = types.void({row}, {row}, {rows})\nfunction = looped\n{tail}"
    return module_text("A test.", numba_parts([*parts, call, signature], *files))


@pytest.mark.parametrize("name", PIECES)
def test_pieces_in_energy_form(name, monkeypatch):
    given, wanted = PIECES[name]
    assert wanted <= vectors_of(text_of(name, given, [], energy.FILES, ""), monkeypatch)


@pytest.mark.parametrize("name", ["variations"])
def test_the_energy_form_is_compiled_once_on_a_machine(name, monkeypatch):
    texts = []
    monkeypatch.setattr(energy, "native", lambda *text: texts.append(text) or native(*text))
    getattr(energy, name).__wrapped__()
    assert path_of(*texts[0]).exists()
