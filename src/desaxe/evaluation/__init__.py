"""Values of quantities: at a point, over arrays, over a grid.

evaluate       numbers in, a float out; arrays in, arrays out
call           a checked request with its loads
values         values of names from a dict of inputs: the checked request of every call, and its point
under_loads    the request of names under loads that vary with the motion, and what follows from these
arrays         inputs that broadcast, the loops they vary along, outputs and scratch
labelled       labelled arrays: those that broadcast, those that vary together, those that are loads
arcs           arcs of crank angles on which one piece of a load holds
quality        condition numbers and error bounds, under loads too
function       a prepared callable of some inputs
points         the arguments of a grid, checked; steps of a plan: values of names by one kernel
plan           the steps of a grid, its blocks, its dataset, lazy or not
chunks         how a grid, or a reduced axis, is cut
reductions     reductions of a grid along some of its axes: the largest, the mean, the values at one place
grid           an outer product as a labelled dataset
labels         units and CF attributes
in_units       labelled results in other units
"""
