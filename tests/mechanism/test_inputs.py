"""Inputs are listed in `mechanism/inputs.py`; the few places that spell them out again have all of them."""

import inspect
import io
import re
import tokenize
from pathlib import Path

import pytest

import desaxe as dx
from desaxe.machine.summary import NAMES
from desaxe.mechanism.inputs import INPUTS, Inputs, names_in
from desaxe.mechanism.names import LOADS, ORDER, PARAMETERS
from desaxe.mechanism.program import Variant, program_of
from desaxe.oracle import force_truth
from desaxe.scenes.schema import SECTIONS

ROOT = Path(__file__).resolve().parents[2]
MOTION = {"theta", "omega0", "omega", "alpha"}
FORCES = ("T_in", "N_C", "F_A_X", "force_status", "potential_energy")
# What adding an input touches, besides tests and documents: file -> the inputs that it has.
PLACES = {
    "src/desaxe/mechanism/inputs.py": lambda: Inputs.__annotations__,
    "src/desaxe/evaluation/evaluate.py": lambda: inspect.signature(dx.evaluate).parameters,
    "src/desaxe/simulation/simulate.py": lambda: {*inspect.signature(dx.simulate).parameters, *MOTION},
    "derive/bodies.py": lambda: {*program_of(FORCES, Variant()).inputs, "omega"},
    "src/desaxe/oracle/force_truth.py": lambda: {*force_truth.PARAMETERS, *force_truth.STATE_PARAMETERS},
}
ENTERS = {"derive/dynamics.py"}  # where an input that changes the effective inertia stands, too


@pytest.mark.parametrize("file", PLACES)
def test_a_place_has_every_input(file):
    lacking = [name for name in INPUTS if name not in PLACES[file]()]
    assert not lacking, f"{file} lacks {', '.join(lacking)}"


def test_nothing_else_lists_inputs():
    """What else needs their names has them from `INPUTS`."""
    names = names_in("masses")
    files = [
        path
        for room in ("src", "derive")
        for kind in ("py", "js")
        for path in (ROOT / room).rglob(f"*.{kind}")
    ]
    texts = {path: path.read_text(encoding="utf-8") for path in files}
    listing = {
        path.relative_to(ROOT).as_posix()
        for path, text in texts.items()
        if all(name in text for name in names) and set(names) <= words(path, text)
    }
    assert listing - ENTERS <= set(PLACES)


def words(path, text):
    """The words of a file; of Python without docstrings and comments."""
    if path.suffix == ".js":
        return set(re.findall(r"\w+", text))
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    kept = [token.string for token in tokens if token.type in (tokenize.NAME, tokenize.STRING)]
    return {word for text in kept if not text.startswith('"""') for word in re.findall(r"\w+", text)}


def test_an_input_stands_in_the_section_of_its_row():
    for section, table in SECTIONS.items():
        keys = {name for name, row in INPUTS.items() if row.section == section}
        assert keys == {*table["properties"]} - {"branch"}


def test_parameters_of_sensitivities():
    assert set(ORDER) == set(INPUTS) == {*PARAMETERS, *LOADS, "omega"}


def test_the_summary_of_a_machine():
    assert set(NAMES) == {*INPUTS, "branch"} - {"theta"}
    assert all(NAMES.values())
