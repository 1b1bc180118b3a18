"""Freeze the truths that `desaxe doctor --accuracy` compares with: `python -m benchmarks.accuracy.freeze`."""

from itertools import islice
from pathlib import Path

import desaxe.cli
from desaxe.cli.doctor import INPUTS
from desaxe.oracle.families import FAMILIES, points
from desaxe.oracle.truth import conditions, truth_all

from .errors import ULPS

TABLE = Path(desaxe.cli.__file__).with_name("truths.txt")
NAMES = ("Y", "phi", "V_C", "omega_BC", "a_C", "alpha_BC", "a_C_wrt_ec", "V_C_wrt_AB")
ROWS, SEED = 200, 60
LEAST, MOST = 1e-30, 1e30  # of what is written
EXCUSED = 2.0**40  # ulp: a promise that leaves few digits says nothing


def text() -> str:
    """The table: name, branch, inputs, true value, promised error in ulp."""
    return "".join(f"{row}\n" for row in islice(_rows(), ROWS))


def _rows():
    """One name at a point of each family in turn."""
    drawn = {family: points(family, 10 * ROWS, SEED) for family in FAMILIES}
    for number in range(10 * ROWS):
        name = NAMES[number % len(NAMES)]
        point = next(drawn[list(FAMILIES)[number % (len(FAMILIES) + 1) % len(FAMILIES)]])
        value = float(truth_all((name,), **point)[name])
        promised = ULPS * (1.0 + float(conditions(name, **point)))
        sizes = [abs(x) for x in (value, *(point[p] for p in INPUTS)) if x]
        if value and promised < EXCUSED and all(LEAST < size < MOST for size in sizes):
            inputs = " ".join(repr(float(point[p])) for p in INPUTS)
            yield f"{name} {point['branch']} {inputs} {value!r} {promised:.4g}"


if __name__ == "__main__":
    TABLE.write_text(text(), encoding="utf-8")
