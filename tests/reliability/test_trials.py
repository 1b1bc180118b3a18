"""The short form of `python -m tests.reliability`: a few seeds of every kind of trial."""

import json
import random
from pathlib import Path

import pytest

import desaxe as dx
from desaxe.compiler.languages import languages
from tests.reliability.hostile import calls, scene_keys
from tests.reliability.rig import RIGHT
from tests.reliability.trials import TRIALS

ROOT = Path(__file__).resolve().parents[2]
RANGES = {"start", "stop", "num", "step"}


# Whoever used JAX in this process is warned at each fork; the children do not use it.
@pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning")
@pytest.mark.parametrize("trial", [trial for trial in TRIALS if trial.short], ids=lambda trial: trial.what)
def test_a_few_seeds(trial, tmp_path):
    for seed in range(trial.short):
        folder = tmp_path / str(seed)
        folder.mkdir()
        verdict = trial.run(folder, random.Random(seed))
        assert verdict.outcome == RIGHT, (seed, verdict)


def test_every_public_call_has_a_row():
    """What is public enters the trials of bad values on the day it is added."""
    public = {name for name in dx.__all__ if callable(getattr(dx, name)) and not name.endswith("Warning")}
    assert public - {call.split()[0] for call in calls()} == set()


def test_every_language_and_every_key_of_a_scene_is_tried():
    assert {f"compile to {language.name}" for language in languages()} <= set(calls())
    schema = json.loads((ROOT / "docs" / "scene.schema.json").read_text(encoding="utf-8"))
    names: set[str] = set()
    json.loads(json.dumps(schema), object_hook=lambda rule: names.update(rule.get("properties", ())) or rule)
    assert names - {key for path in scene_keys() for key in path} - RANGES == set()
