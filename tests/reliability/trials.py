"""All kinds of trials."""

from tests.reliability import cache, files, hostile, memory, processes

TRIALS = [*files.TRIALS, *cache.TRIALS, *processes.TRIALS, *hostile.TRIALS, *memory.TRIALS]
