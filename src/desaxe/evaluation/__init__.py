"""Values of quantities: at a point, over arrays, over a grid.

evaluate       numbers in, a float out; arrays in, arrays out
arrays         inputs that broadcast, outputs and scratch
loops          the loop that each input of a broadcast varies along
grid           an outer product as a labelled dataset
axes           its arguments, and axes joined to long loops
chunks         how a grid, or a reduced axis, is cut
plan           the steps of a grid, its blocks, its dataset
points         a step: values of names by one kernel, loads included
reduced        a step: the largest, the mean, ... along axes; which kernel reduces, and how pieces combine
measures       steps: a name at one place of a reduced axis, a function of the design
lazy           a plan as Dask arrays
labels         units and CF attributes
quality        condition numbers and error bounds
values         values of names from a dict of inputs: the body of `evaluate`
function       a prepared callable of some inputs
call_cache     repeated calls of one shape: a cache of checked calls
loaded         values under loads that vary with the motion
under          loads in a kernel: its request, its tables, points that rounding leaves open
under_request  the request of names under loads, and their tables
under_points   names under loads at the points of large arrays, by one kernel
loaded_quality condition numbers and error bounds under loads that are tables
repair         points that a kernel leaves undecided, recomputed
lazy_evaluate  `evaluate` of Dask arrays
labelled       `evaluate` of labelled arrays
dask_blocks    a function of many outputs over the chunks of Dask arrays
in_units       labelled results in other units
reductions     the argument `reduce=`, checked
kinds          the kinds of reductions: a row for each
in_memory      kinds of arrays in memory over several axes, and of pieces
own_measure    a user's function of a design as a measure
arcs           arcs of crank angles on which one piece of a load holds
sides          on which side of a jump of a load samples are
extremes       inputs near the ends of the double range, rescaled
"""
