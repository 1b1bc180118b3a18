"""Values of quantities: at a point, over arrays, over a grid.

evaluate  numbers in, a float out; arrays in, arrays out
arrays    inputs that broadcast, outputs and scratch
loops     the loop that each input of a broadcast varies along
grid      an outer product as a labelled dataset
outer     its arguments, and axes joined to long loops
chunks    how a grid is cut
blocks    parts of a grid, for chunks
lazy      grids and arrays of Dask
reduce    the largest, the mean, ... of an axis, without storing the grid
labels    units and CF attributes
quality   condition numbers and error bounds
"""
