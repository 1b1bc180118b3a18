"""The JSON schema of scenes: committed, fresh, and of one opinion with the reader."""

import copy
import tomllib
from pathlib import Path

import jsonschema
import pytest

from desaxe.cli import main
from desaxe.mechanism.inputs import INPUTS
from desaxe.scenes.scene import scene
from desaxe.scenes.schema import SceneError, json_schema, json_schema_text
from tests.example_scenes import SMALL, changed

ROOT = Path(__file__).parents[2]
COMMITTED = ROOT / "docs" / "scene.schema.json"
EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
VALIDATOR = jsonschema.Draft202012Validator(json_schema())


def test_committed_schema_is_fresh():
    remedy = "run: desaxe scene --schema > docs/scene.schema.json"
    assert COMMITTED.read_text(encoding="utf-8") == json_schema_text(), remedy


def test_command(capsys):
    assert main(["scene", "--schema"]) == 0
    assert capsys.readouterr().out == json_schema_text()


def test_schema_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(json_schema())


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_examples(path):
    text = path.read_text(encoding="utf-8")
    first = text.splitlines()[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == COMMITTED
    VALIDATOR.validate(tomllib.loads(text))


def test_every_input_tells_its_unit():
    keys = json_schema()["properties"]
    message = {
        name: rule["title"]
        for section in ("mechanism", "motion", "masses", "loads")
        for name, rule in keys[section]["properties"].items()
        if name != "branch"
    }
    assert set(message) == set(INPUTS)
    assert all(f"[{INPUTS[name].unit}]" in text for name, text in message.items())


GOOD = {
    "reduce": {"theta": ["absmax", "mean"]},
    "threads": 2,
    "accuracy": 1e-9,
    "outputs": ["a_C", "a_C_wrt_ec_BC"],
    "results.data": "x.zarr",
}
WRONG = {
    "reduce": {"theta": "absmx"},
    "threads": 0,
    "outputs": [3],  # a name that nobody knows may be a quantity of the user's own
    "mechanism.branch": 2,
    "mechanism.CB": 1,
    "motion.theta": {"start": 0},
    "titel": "x",
    "check": [{"printed": {"a_C": 1}, "at": {"bc": 1}}],
    "peak": [{"quantity": "a_C", "kind": "largest"}],
}


@pytest.mark.parametrize("path", GOOD)
def test_what_the_reader_takes_the_schema_takes(path):
    data = changed(path, GOOD[path])
    scene(copy.deepcopy(data))
    VALIDATOR.validate(data)


@pytest.mark.parametrize("path", WRONG)
def test_what_the_schema_refuses_the_reader_refuses(path):
    data = changed(path, WRONG[path])
    assert not VALIDATOR.is_valid(data)
    with pytest.raises(SceneError):
        scene(data)


def test_defaults_are_no_keys():
    VALIDATOR.validate(SMALL)
