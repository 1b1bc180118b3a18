"""All kinds of trials."""

from tests.reliability import cache, files, forks, hostile, memory, processes

TRIALS = [*files.TRIALS, *cache.TRIALS, *processes.TRIALS, *forks.TRIALS, *hostile.TRIALS, *memory.TRIALS]
