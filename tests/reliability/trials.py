"""All kinds of trials."""

from tests.reliability import files

TRIALS = [*files.TRIALS]
