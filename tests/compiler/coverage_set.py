"""The expressions that every emitter must pass: each operation, and each way that two can nest.

One readable program; a new operation, or a precedence that went wrong once, gets a line here. Every
result is a number, and a truth value is shown by a select.
"""

from desaxe.compiler.program import Program
from desaxe.compiler.text import read_function

TEXT = '''def coverage(x, y, z):
    """All of it."""
    plain = x
    constant = 0.1
    negative_constant = -2.0 * x
    sub_of_sub = x - (y - z)
    sub_sub = x - y - z
    sub_of_add = x - (y + z)
    sub_of_negative = x - -2.0
    div_of_div = x / (y / z)
    div_div = x / y / z
    div_of_mul = x / (y * z)
    mul_of_div = x * (y / z)
    mul_of_sum = (x + y) * (y - z)
    div_of_sum = (x + y) / (y * y + 1.0)
    neg_of_sum = -(x + y)
    neg_of_mul = -(x * y)
    neg_times = -x * y
    neg_neg = -(-x)
    sub_of_neg = x - -y
    roots = sqrt(fabs(x * y)) + sqrt(z * z + 1.0)
    waves = sin(x) * cos(y) - sin(x - y)
    angle = atan2(x, y) + atan2(-x, y + z)
    size = fabs(x) - fabs(-y)
    length = hypot(x + y, -z) - hypot(x, y)
    grown = exp(x) + log(fabs(y) + 1.0) * pow(fabs(z), y)
    wholes = floor(x * 3.0) + floor(-y)
    signed = copysign(x, y - z) * copysign(2.0, z)
    lost = x + y + two_sum_error(x, y) * 0.5
    lost_too = x * y + two_product_error(x, y) * 0.5
    added = mul_add(x + y, -z, x - y) + mul_add(x, y, mul_add(-x, y, z))
    lost_at_most = x + y + rounding(x) * 0.5
    scale = power_of_two(x) + power_of_two(y) - power_of_two(z * z)
    quarter_turns = rotated_sin(x, y, floor(z)) + rotated_sin(x, y, -1.0)
    their_cosine = rotated_cos(x, y, floor(z)) + rotated_cos(x, y, 1.0)
    least = x if x < y else y
    chosen = x if x < y else (y if y <= z else z)
    chosen_early = (x if x < y else y) - (y if z < y else z)
    tested_choice = 1.0 if (x if x < y else y) < z else 2.0
    both = 1.0 if x < y and y < z else 0.0
    either = 1.0 if x < y or y < z and z <= x else 0.0
    grouped = 1.0 if (x < y or y < z) and z <= x else 0.0
    neither = 1.0 if not (x < y or y < z) else 0.0
    negated = 1.0 if (not x < y) and not y <= z else 0.0
    equal = 1.0 if x == y or x + y == z else 0.0
    plainer = x - y if extended_only(x < y) else y - z
    state = 3 if x < y else (1 if y < z else 0)
    missing = nan if x < -1000.0 else x
    return {outputs}
'''
NAMES = tuple(line.split(" = ")[0].strip() for line in TEXT.splitlines() if " = " in line)

POINTS = (
    {"x": 0.7, "y": -1.3, "z": 2.1},
    {"x": -3.25, "y": 0.4, "z": 0.1},
    {"x": 2.0, "y": 2.0, "z": 4.0},
    {"x": 1e-9, "y": 5.5, "z": -7.75},
    {"x": -0.1, "y": -0.2, "z": -0.3},
)


def coverage() -> Program:
    """The program."""
    return read_function(TEXT.format(outputs=", ".join(NAMES)))
