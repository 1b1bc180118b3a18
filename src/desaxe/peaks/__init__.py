"""Refined extrema over the crank angle.

peak      the public call
programs  a quantity, its slope over theta and its gradient, as Programs
nodes     the crank angles at which a search starts
search    the search of one design, in loops that numba compiles
special   special designs: limit angles, stall, friction
compiled  the module of a search
by_arrays the functions of a quantity in NumPy, for a search that is new
stubs     stand-ins for the functions of a quantity
designs   the search over all designs of a request
loaded    peaks under loads that vary with the motion
lazy      peaks as Dask arrays
"""
