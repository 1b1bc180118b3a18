"""The crank angles that put the slider at a position: a Program.

The triangle A B C has the sides AB, BC and L = |AC|; its angle at A comes from the half-angle form, whose
factors are what two sides are longer than the third. Where the triangle is flat one of them is small: it is
taken from a difference of squares with the rounding errors of its parts, so that it keeps its digits, and is
0 where the sides of the doubles given are in line.
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
    in_line = crank + rod
    in_line_square = in_line * in_line
    in_line_lost = two_product_error(in_line, in_line) + 2.0 * in_line * two_sum_error(crank, rod)
    rod_over = rod - crank
    rod_over_square = rod_over * rod_over
    rod_over_lost = two_product_error(rod_over, rod_over) + 2.0 * rod_over * two_sum_error(rod, -crank)
    along_square = along * along
    across_square = across * across
    L_lost = two_product_error(along, along) + two_product_error(across, across)
    outer_part = in_line_square - along_square
    outer_square = outer_part - across_square
    outer_lost = two_sum_error(in_line_square, -along_square) + two_sum_error(outer_part, -across_square)
    outer_room = (outer_square + (outer_lost + (in_line_lost - L_lost))) / (in_line + L)  # 1 | AB + BC - L
    inner_part = along_square - rod_over_square
    inner_square = inner_part + across_square
    inner_lost = two_sum_error(along_square, -rod_over_square) + two_sum_error(inner_part, across_square)
    far_room = L + fabs(rod_over)  # 1 | what L and the longer link are longer than the shorter one
    near_room = (inner_square + (inner_lost + (L_lost - rod_over_lost))) / far_room if 0.0 < far_room else 0.0
    above = outer_room * (far_room if crank <= rod else near_room)
    below = (in_line + L) * (near_room if crank <= rod else far_room)
    is_flat = above == 0.0 or below == 0.0
    beta = 2.0 * atan2(sqrt(above), sqrt(below))  # rad | angle of the triangle at A
    middle = atan2(-across, along)  # rad | crank angle that points at the slider
    one = middle - beta
    other = middle + beta
    one_turn = one + {2 * pi!r} if one <= {-pi!r} else one
    other_turn = other - {2 * pi!r} if {pi!r} < other else (other + {2 * pi!r} if other <= {-pi!r} else other)
    one_rise = along - crank * cos(one_turn)  # 1 | 0 at a limit angle, which is counted on branch 1 alone
    other_rise = along - crank * cos(other_turn)
    one_fits = 0.0 <= one_rise if 0.0 < branch else one_rise < 0.0
    other_fits = 0.0 <= other_rise if 0.0 < branch else other_rise < 0.0
    one_good = one_turn if one_fits else nan
    other_good = other_turn if other_fits else nan
    swapped = not one_fits or (other_fits and other_good < one_good)
    first = other_good if swapped else one_good
    last = one_good if swapped else other_good
    second = nan if is_flat and first == last else last
    status = 2 if is_flat and first == first else (0 if first == first else 1)
    return first, second, status
'''
