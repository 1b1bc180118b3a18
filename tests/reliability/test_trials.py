"""The short form of `python -m tests.reliability`: a few seeds of every kind of trial."""

import random

import pytest

from tests.reliability.rig import RIGHT
from tests.reliability.trials import TRIALS


@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: trial.what)
def test_a_few_seeds(trial, tmp_path):
    for seed in range(trial.short):
        folder = tmp_path / str(seed)
        folder.mkdir()
        verdict = trial.run(folder, random.Random(seed))
        assert verdict.outcome == RIGHT, (seed, verdict)
