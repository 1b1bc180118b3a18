"""Run time against error, beside everyone else, in one run: `python -m benchmarks`."""
