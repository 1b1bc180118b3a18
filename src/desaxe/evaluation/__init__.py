"""Values of quantities: at a point, over arrays, over a grid.

evaluate       numbers in, a float out; arrays in, arrays out
arrays         inputs that broadcast, the loops they vary along, outputs and scratch
grid           an outer product as a labelled dataset
chunks         how a grid, or a reduced axis, is cut
plan           the steps of a grid, its blocks, its dataset, lazy or not
points         the arguments of a grid, checked; steps of a plan: values of names by one kernel
labels         units and CF attributes
quality        condition numbers and error bounds, under loads too
function       a prepared callable of some inputs
values         values of names from a dict of inputs: the body of `evaluate`
labelled       `evaluate` of labelled arrays, and grids whose inputs vary together
in_units       labelled results in other units
reductions     reductions of a grid along some of its axes: the largest, the mean, the values at one place
under_loads    values under loads that vary with the motion
"""
