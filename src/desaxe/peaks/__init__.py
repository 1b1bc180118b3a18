"""Refined extrema over the crank angle.

peak         the public call
programs     a quantity, its slope over theta and its gradient, as Programs
nodes        the crank angles at which a search starts
search       the search of one design, in loops that numba compiles
columns      its parts for designs with nodes of their own, and the tables of loads
special      special designs: limit angles, stall, friction
compiled     the module of a search
by_arrays    the functions of a quantity in NumPy, for a search that is new
designs      the search over all designs of a request
loaded       the search under loads that vary with the motion
under        the compiled search under tables, and these as its arguments
course       these loads over the angle: kinks, jumps, nodes
jumps        extrema at jumps and kinks: their side, angle and gradient
differences  the slope of a load that is a function, where it was not given
block        the peaks of a block of designs
"""
