"""Refined extrema over the crank angle.

peak      the public call
designs   the plan of a request, and the search over all of its designs
search    the search, in arrays: bounds, candidates, Newton's method
programs  a quantity, its slope over theta and its gradient, as Programs and in machine code
nodes     the crank angles at which a search starts
special   special designs: limit angles, stall, friction
loaded    value, slope and gradient under loads that vary with the motion
course    these loads over the angle: kinks, jumps, nodes
jumps     extrema at jumps and kinks: their side, angle and gradient
"""
