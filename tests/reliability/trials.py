"""All kinds of trials."""

from tests.reliability import cache, files, forks, hostile, memory, processes, stores

KINDS = (files, cache, processes, forks, hostile, memory, stores)
TRIALS = [trial for kind in KINDS for trial in kind.TRIALS]
