"""Several sliders on one crankshaft: every quantity of the shaft is a sum over its sliders.

sums       quantities and sensitivities, each slider by state at its own angle
cycle      the cycle of the shaft: the edges of all sliders
extreme    the extreme value of a sum
motion     its equation of motion
sliders    what calls take as `sliders=`
"""
