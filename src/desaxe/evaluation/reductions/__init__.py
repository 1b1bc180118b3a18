"""Reductions of a grid along some of its axes: the largest, the mean, the values at one place.

argument     the argument `reduce=`, checked
kinds        the kinds of reductions: a row for each, and what they are of arrays in memory
reduced      steps: kinds along axes, a name at one place of an axis, a function of the design
own_measure  a user's function of a design as a measure
"""
