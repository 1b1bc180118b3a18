"""Dead centres, stroke, time ratio and extreme angles of the rod, with their derivatives: a Program.

Crank and rod are in line with S = AB + BC between A and C (outer), or D = BC - AB (inner):

    Y_o = sqrt((S - ec) (S + ec)),   theta_o = -asin(ec/S)
    Y_i = sqrt((D - ec) (D + ec)),   theta_i = pi - asin(ec/D)

Differences of these are rewritten so that nothing cancels. With Y_o^2 - Y_i^2 = 4 AB BC,

    stroke = Y_o - Y_i = 4 AB BC/(Y_o + Y_i)
    beta = asin(ec/D) - asin(ec/S) = atan2(ec stroke, Y_o Y_i + ec^2)

beta, the angle between the dead centres as seen from A, is what one stroke turns more than half a turn and
the other less. S - |ec| and D - |ec| are exact sums rounded once; lengths are divided by a power of two, so
that no square leaves the range of doubles. `derive/closed.py` proves that the lines of derivatives are those
of the values, and puts all lines into the Program of the derivation.
"""

from math import pi

from ..names import LENGTHS, TURN_STATUS, WHOLE, sensitivity

PLACES = ("theta_max_pressure_angle", "theta_min_pressure_angle")
SENSITIVITIES = tuple(sensitivity(name, length) for name in WHOLE for length in LENGTHS)
NEXT = "\n    "
# Of values by ec, AB and BC; a row of two slopes has the same by BC as by AB.
_GRADIENTS = """
Y_outer; -branch * (offset / outer_height); branch * (in_line / outer_height)
theta_outer; -branch / outer_height / unit_length; branch * (offset / (in_line * outer_height)) / unit_length
theta_inner; -inner_branch / inner_height / unit_length; -inner_swing; inner_swing
advance_angle; outward * beta_wrt_ec; outward * beta_wrt_AB; outward * beta_wrt_BC
return_angle; -outward * beta_wrt_ec; -outward * beta_wrt_AB; -outward * beta_wrt_BC
time_ratio; ratio_by_beta * beta_wrt_ec; ratio_by_beta * beta_wrt_AB; ratio_by_beta * beta_wrt_BC
max_pressure_angle; offset_side * steeper; steeper; -(reach_out / rod) * steeper
min_transmission_angle; -offset_side * steeper; -steeper; (reach_out / rod) * steeper
min_pressure_angle; offset_side * flatter; -flatter; -(reach_in / rod) * flatter
max_transmission_angle; -offset_side * flatter; flatter; (reach_in / rod) * flatter
"""
_ROWS = (row.split("; ") for row in _GRADIENTS.strip().splitlines())
_SLOPES = [
    f"{name}_wrt_{p} = {slope}"
    for name, *slopes in _ROWS
    for p, slope in zip(LENGTHS, (*slopes, slopes[-1]), strict=False)
]
DEAD_CENTRES = f'''def dead_centres(ec, AB, BC, branch, turning):
    """Quantities of a whole design; branch -1 mirrors it across X, turning -1 turns it backwards."""
    longer_link = BC if AB < BC else AB
    longest = fabs(ec) if longer_link < fabs(ec) else longer_link
    unit_length = power_of_two(longest)  # m | a power of two near the longest length
    offset = ec / unit_length  # 1 | ec, in this length
    away = fabs(offset)
    crank = AB / unit_length  # 1 | AB, in this length
    rod = BC / unit_length  # 1 | BC, in this length
    in_line = crank + rod
    in_line_lost = two_sum_error(crank, rod)
    rod_over = rod - crank
    rod_over_lost = two_sum_error(rod, -crank)
    room_outer_sum = in_line - away
    room_outer = room_outer_sum + (in_line_lost + two_sum_error(in_line, -away))  # 1 | S - |ec|
    room_turn_sum = rod_over - away
    room_turn = room_turn_sum + (rod_over_lost + two_sum_error(rod_over, -away))  # 1 | the margin
    room_long_sum = -rod_over - away
    room_long = room_long_sum + (two_sum_error(-rod_over, -away) - rod_over_lost)
    room_inner = room_turn if crank < rod else room_long  # 1 | |D| - |ec|
    can_turn = 0.0 <= room_turn
    outer_height = sqrt(room_outer * (in_line + away))  # 1 | Y_o
    inner_height = sqrt(room_inner * (fabs(rod_over) + away))  # 1 | |Y_i|
    inner_turning = inner_height if can_turn else nan  # 1 | Y_i where the crank turns fully
    inner_side = -1.0 if rod_over < 0.0 else 1.0  # 1 | sign of Y_i: a long crank takes the slider past A
    offset_side = 1.0 if 0.0 < offset else (-1.0 if offset < 0.0 else 0.0)  # 1 | sign of ec
    Y_outer = branch * outer_height * unit_length  # m | slider position at the outer dead centre
    inner_branch = branch * inner_side
    Y_inner = inner_branch * inner_height * unit_length  # m | slider position at the inner dead centre
    Y_inner_wrt_ec = -inner_branch * (offset / inner_height)
    Y_inner_wrt_AB = -branch * (fabs(rod_over) / inner_height)
    Y_inner_wrt_BC = branch * (fabs(rod_over) / inner_height)
    outer_turn = atan2(0.0 if offset == 0.0 else -offset, outer_height)
    outer_base = {pi!r} if branch < 0.0 else 0.0
    theta_outer = outer_base + branch * outer_turn  # rad | crank angle of the outer dead centre
    inner_turn = atan2(0.0 if offset == 0.0 else -inner_side * offset, inner_height)
    inner_base = 0.0 if branch < 0.0 else {pi!r}
    theta_inner = inner_base + branch * inner_turn  # rad | crank angle of the inner dead centre
    inner_swing = inner_branch * (offset / (rod_over * inner_height)) / unit_length
    links = 4.0 * crank * rod
    heights = outer_height * inner_turning
    no_crank = can_turn and crank == 0.0
    stroke_in_unit = 0.0 if no_crank else links / (outer_height + inner_turning)
    stroke = stroke_in_unit * unit_length  # m | distance between the dead centres
    stroke_wrt_ec = offset * stroke_in_unit / heights
    stroke_wrt_AB = in_line / outer_height + rod_over / inner_turning
    crossed = in_line * inner_turning + rod_over * outer_height
    stroke_wrt_BC = -offset * offset * links / (heights * crossed)
    beta = atan2(offset * stroke_in_unit, heights + offset * offset)  # rad | between the dead centres at A
    beta_wrt_ec = stroke_in_unit / heights / unit_length
    beta_wrt_AB = (offset / (rod_over * inner_turning) + offset / (in_line * outer_height)) / unit_length
    along = in_line * outer_height + rod_over * inner_turning
    squares = in_line * in_line + inner_turning * inner_turning
    all_sides = rod_over * inner_turning * in_line * outer_height * along
    beta_wrt_BC = -links * offset * squares / all_sides / unit_length
    outward = branch * turning
    advance_angle = {pi!r} + outward * beta  # rad | crank angle of the stroke outward
    return_angle = {pi!r} - outward * beta  # rad | crank angle of the stroke inward
    shorter_angle = {pi!r} - fabs(beta)
    time_ratio = 1.0 + 2.0 * fabs(beta) / shorter_angle  # 1 | slower over faster stroke in time | B (51)
    ratio_by_beta = offset_side * ({2 * pi!r} / (shorter_angle * shorter_angle))
    reach_out = crank + away  # 1 | how far the rod leans out at most
    least_height = sqrt(room_turn * (rod + reach_out))
    max_pressure_angle = atan2(reach_out, least_height)  # rad | largest pressure angle
    steeper = 1.0 / least_height / unit_length
    min_transmission_angle = atan2(least_height, reach_out)  # rad | smallest transmission angle
    reach_in = (away - crank if crank < away else 0.0) if can_turn else nan  # 1 | the least that it leans out
    room_flat = room_outer if crank < away else rod
    most_height = sqrt(room_flat * (rod + reach_in))
    min_pressure_angle = atan2(reach_in, most_height)  # rad | smallest pressure angle
    is_out = can_turn and crank < away
    flatter = 1.0 / most_height / unit_length if is_out else (0.0 if can_turn else nan)
    max_transmission_angle = atan2(most_height, reach_in)  # rad | largest transmission angle
    steep_angle = {-pi / 2!r} if offset < 0.0 else {pi / 2!r}
    theta_max_pressure_angle = steep_angle if can_turn else nan  # rad | where the rod is steepest
    across = atan2(0.0 if offset == 0.0 else -offset, sqrt(crank - offset) * sqrt(crank + offset))
    flat_angle = across if away <= crank else -steep_angle
    theta_min_pressure_angle = flat_angle if can_turn else nan  # rad | where it is flattest
    {NEXT.join(_SLOPES)}
    turn_status = 2 if room_turn == 0.0 else (0 if can_turn else 1)  # 1 | of the design
    return {", ".join((*WHOLE, *SENSITIVITIES, *PLACES, TURN_STATUS))}
'''
