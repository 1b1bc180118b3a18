"""Inputs are listed in `mechanism/inputs.py`; the places that spell them out again have all of them."""

import inspect
import re
from importlib.resources import files

import desaxe as dx
from desaxe.machine.summary import NAMES
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.names import LOADS, ORDER, PARAMETERS
from desaxe.scenes.needs import SECTIONS


def test_parameters_of_sensitivities():
    assert set(ORDER) == set(INPUTS) == {*PARAMETERS, *LOADS, "omega"}


def test_signatures():
    assert set(INPUTS) <= set(inspect.signature(dx.evaluate).parameters)
    motion = {"theta", "omega0", "omega", "alpha"}
    assert set(INPUTS) - motion <= set(inspect.signature(dx.simulate).parameters)


def test_keys_of_scenes():
    keys = [name for table in SECTIONS.values() for name in table.__struct_fields__]
    assert sorted(keys) == sorted([*INPUTS, "branch"])


def test_a_scene_exported_by_the_explorer():
    text = (files("desaxe.scenes.explorer") / "page" / "files.js").read_text(encoding="utf-8")
    listed = re.findall(r'"(\w+)"', text[text.index("const SECTIONS") : text.index("];")])
    assert sorted(listed) == sorted([*SECTIONS, *INPUTS.keys() - {"theta"}])


def test_the_summary_of_a_machine():
    assert set(NAMES) == {*INPUTS, "branch"} - {"theta"}
