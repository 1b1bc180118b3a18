"""Run time against error, beside everyone else, in one run: `python -m benchmarks`.

work         the works and their inputs
contenders/  desaxe and its peers, one file each
formulas     the textbook forms that the peers compute
rows         works beside others in one process: peaks, motions, steady states, loads, generated/
blocks       blocks of points, for peers that take a matrix
child        one contender in a process of its own
rig          a call, timed
accuracy/    `python -m benchmarks --accuracy`: every accuracy of desaxe beside the textbook's formula
race         contenders in turns at a work
errors       errors against the truth, by the rig of `accuracy/`
load         bytes and operations of a work at each point
measure      a whole run as plain data
growth       time over the number of points
starts       cold starts
report       docs/benchmarks.md and the table of docs/measured.md
picture      the pictures of that page
startup      first calls and second processes; `python -m benchmarks.startup` alone
tolerances   `python -m benchmarks.tolerances`: errors of motions beside the tolerance asked for
scale        `python -m benchmarks.scale`: sweeps
"""
