"""The short form of `python -m tests.reliability`: a few seeds of every kind of trial."""

import random

import pytest

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
