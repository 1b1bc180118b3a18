"""Refined extrema over the crank angle.

peak         the public call
programs     a quantity, its slope over theta and its gradient, as Programs
nodes        the crank angles at which a search starts
search       the search, in arrays
steps        its straight lines: a bound, a first guess, a step of Newton's method
evaluations  value, slope and gradient in machine code
special      special designs: limit angles, stall, friction
designs      the search over all designs of a request
loaded       value, slope and gradient under loads that vary with the motion
course       these loads over the angle: kinks, jumps, nodes
jumps        extrema at jumps and kinks: their side, angle and gradient
differences  the slope of a load that is a function, where it was not given
block        the peaks of a block of designs
"""
