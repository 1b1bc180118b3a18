"""All kinds of trials."""

from tests.reliability import files, forks, hostile, memory, processes, stores

KINDS = (files, processes, forks, hostile, memory, stores)
TRIALS = [trial for kind in KINDS for trial in kind.TRIALS]
