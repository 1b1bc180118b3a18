"""Closed forms of the geometry as Programs: one text for numbers, arrays and every language.

dead_centres  dead centres, stroke, time ratio, extreme angles of the rod, with their derivatives
limits        the crank angles at which a design can be assembled
inverse       the crank angles that put the slider at a position
functions     a closed form in plain Python and in NumPy
angles        crank angles of many designs, repeated over turns
"""

from math import pi

TURN = 2.0 * pi  # rad
