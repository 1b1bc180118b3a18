"""Reductions of a grid along some of its axes: the largest, the mean, the values at one place.

reduced      a step: the largest, the mean, ... along axes; which kernel reduces, and how pieces combine
measures     steps: a name at one place of a reduced axis, a function of the design
argument     the argument `reduce=`, checked
kinds        the kinds of reductions: a row for each
in_memory    kinds of arrays in memory over several axes, and of pieces
own_measure  a user's function of a design as a measure
"""
