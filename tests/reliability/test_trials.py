"""The short form of `python -m tests.reliability`: a few seeds of every kind of trial."""

import random

import pytest

import desaxe as dx
from tests.reliability.hostile import calls
from tests.reliability.rig import RIGHT
from tests.reliability.trials import TRIALS


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
