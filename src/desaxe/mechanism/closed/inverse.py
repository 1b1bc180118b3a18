"""The crank angles that put the slider at a position: a Program.

The triangle A B C has the sides AB, BC and L = |AC|; its angle at A comes from the half-angle form, which
keeps its digits where the triangle is flat.
"""

from math import pi

INVERSE = f'''def inverse(Y, ec, AB, BC, branch):
    """The crank angles that put the slider at Y, ascending, in (-pi, pi]."""
    longer_link = BC if AB < BC else AB
    farther = fabs(Y) if fabs(ec) < fabs(Y) else fabs(ec)
    unit_length = power_of_two(longer_link if farther < longer_link else farther)  # m | near the longest
    across = ec / unit_length
    along = Y / unit_length
    crank = AB / unit_length
    rod = BC / unit_length
    L = hypot(across, along)  # 1 | distance of the slider from the crank centre
    above = (rod - (L - crank)) * (rod + (L - crank))
    below = ((L + crank) - rod) * ((L + crank) + rod)
    is_flat = above == 0.0 or below == 0.0
    beta = 2.0 * atan2(sqrt(above), sqrt(below))  # rad | angle of the triangle at A
    middle = atan2(-across, along)  # rad | crank angle that points at the slider
    one = middle - beta
    other = middle + beta
    one_turn = one + {2 * pi!r} if one <= {-pi!r} else one
    other_turn = other - {2 * pi!r} if {pi!r} < other else (other + {2 * pi!r} if other <= {-pi!r} else other)
    one_fits = 0.0 <= (along - crank * cos(one_turn)) * branch
    other_fits = 0.0 <= (along - crank * cos(other_turn)) * branch
    one_good = one_turn if one_fits else nan
    other_good = other_turn if other_fits else nan
    swapped = not one_fits or (other_fits and other_good < one_good)
    first = other_good if swapped else one_good
    last = one_good if swapped else other_good
    second = nan if is_flat and first == last else last
    status = 2 if is_flat and first == first else (0 if first == first else 1)
    return first, second, status
'''
