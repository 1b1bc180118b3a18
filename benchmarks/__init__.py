"""Run time against error, in one run on one core: `python -m benchmarks`."""
