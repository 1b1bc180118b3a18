"""Closed forms from the raw triangle A B C at 60 digits and more, in ball arithmetic.

Dead centres: A, B and C are in line, so |AC| is AB + BC or |AB - BC|; the rod leans by asin(u/BC).
Each quantity is a Taylor polynomial in ec, AB and BC; of |ec| at 0 the mean of both sides is meant.
"""

import math

from flint import arb, arb_series

from desaxe.oracle.jet import Jet, precision, settled

BITS = 700  # of tiny lengths beside large ones; the answers have 60 digits
LENGTHS = ("ec", "AB", "BC")
# |ec| = crank AB + rod BC - gap: what is exact may be small.
GAPS = {"margin": (-1, 1), "long crank": (1, -1), "both in line": (1, 1), "offset": (0, 0), "crank": (1, 0)}


def jets(ec, AB, BC, branch):
    """Every quantity of a whole design that exists, by name."""
    x = [Jet({(): arb_series([arb(v)]), (k,): arb_series([1])}, 2) for k, v in enumerate((ec, AB, BC))]
    away = x[0].times(-1 if ec < 0 else 1)
    pi = Jet({(): arb_series([arb.pi()])}, 2)
    result = {}
    for which, reach in (("outer", x[1] + x[2]), ("inner", x[2] - x[1])):
        square = reach * reach - x[0] * x[0]
        if not square.terms[()][0] > 0:
            continue
        folds = which == "inner" and AB > BC
        height = square.sqrt()
        turn = arc_sine(x[0] * reach.inverse())
        result[f"Y_{which}"] = height.times(-branch if folds else branch)
        half = (which == "outer") == (branch < 0)
        result[f"theta_{which}"] = (pi if half else pi.times(0)) - turn.times(branch)
        result[which] = turn
    margin = math.fsum((BC, -AB, -abs(ec)))
    if margin > 0:
        result["stroke"] = (result["Y_outer"] - result["Y_inner"]).times(branch)
        beta = result["inner"] - result["outer"]
        result["advance_angle"], result["return_angle"] = pi + beta.times(branch), pi - beta.times(branch)
        size = beta.times(-1 if ec < 0 else 1)
        result["time_ratio"] = (pi + size) * (pi - size).inverse()
        lean = arc_sine((x[1] + away) * x[2].inverse())
        result["max_pressure_angle"] = lean
        result["min_transmission_angle"] = pi.times(1) * half_of() - lean
        if abs(ec) > AB:
            result["min_pressure_angle"] = arc_sine((away - x[1]) * x[2].inverse())
            result["max_transmission_angle"] = pi * half_of() - result["min_pressure_angle"]
    return {name: jet for name, jet in result.items() if name not in ("outer", "inner")}


def half_of():
    return Jet({(): arb_series([arb(0.5)])}, 2)


def arc_sine(ratio):
    return ratio.arc(ratio.terms[()].asin(), 1)


def truths(ec, AB, BC, branch):
    """Name, or name and parameter -> its value at 60 digits and the smallest sum of condition numbers."""
    with precision(BITS, 1):
        known = jets(ec, AB, BC, branch)
        numbers = {}
        for name, jet in known.items():
            slopes = [jet.partial((k,)) for k in range(3)]
            numbers[name] = jet.partial(()), slopes
            for k, p in enumerate(LENGTHS):
                numbers[f"{name}_wrt_{p}"] = slopes[k], [jet.partial(tuple(sorted((k, j)))) for j in range(3)]
        return {
            name: (settled(value, 60), condition((ec, AB, BC), value, slopes))
            for name, (value, slopes) in numbers.items()
        }


def condition(lengths, value, slopes):
    """The sum of |x/f df/dx| over AB, BC and a gap in place of ec, for the gap with the least."""
    ec, AB, BC = map(arb, lengths)
    side = -1 if lengths[0] < 0 else 1
    sums = []
    for crank, rod in GAPS.values():
        gap = ec - side * (crank * AB + rod * BC)
        by_AB, by_BC = slopes[1] + side * crank * slopes[0], slopes[2] + side * rod * slopes[0]
        steps = abs(gap * slopes[0]) + abs(AB * by_AB) + abs(BC * by_BC)
        sums.append(float((steps / abs(value)).mid()) if value != 0 else math.inf)
    return min((s for s in sums if s == s), default=math.inf)


def design(rng):
    """A random design: anywhere, next to a border or on it, at any scale that doubles hold."""
    AB, BC = 10 ** rng.uniform(-2, 0.5), 10 ** rng.uniform(-1, 1)
    kind = rng.randrange(8)
    gap = rng.choice([0.0, 2.0 ** -rng.randint(2, 50)])
    if kind == 0:
        ec = 0.0
    elif kind == 1:
        AB = 0.0
        ec = rng.uniform(-1, 1) * BC
    elif kind <= 3:  # next to the change point, and at it
        AB, ec, gap = (math.ldexp(round(math.ldexp(v, 40)), -40) for v in (AB, rng.uniform(0, 2), gap))
        BC = AB + ec + gap
    elif kind == 4:  # a crank longer than the rod
        AB = BC * rng.uniform(1, 4)
        ec = rng.uniform(0, 1.3) * (AB - BC)
    elif kind == 5:
        AB *= 10 ** -rng.uniform(0, 8)
        ec = rng.uniform(0, 1.1) * abs(BC - AB)
    elif kind == 6:
        ec = 10 ** rng.uniform(-300, -5)
    else:
        ec = rng.uniform(0, 1.1) * abs(BC - AB)
    ec = ec if rng.random() < 0.5 else -ec
    scale = rng.choice([0, 0, 0, -900, 900, rng.randint(-950, 950)])
    lengths = [math.ldexp(v, scale) for v in (ec, AB, BC)]
    return *(v if abs(v) > 1e-290 or v == 0.0 else 0.0 for v in lengths), rng.choice([1, -1])
