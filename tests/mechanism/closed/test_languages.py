"""Limit angles and the inverse in every language, against the raw triangle at 60 digits.

Those of whole designs, which scenes can ask for, are in `tests/scenes/export/test_whole_design.py`.
"""

import math
import random

import mpmath as mp
import numpy as np
import pytest

from desaxe.compiler.languages import language_of
from desaxe.compiler.passes.pipeline import optimise
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Program, renamed
from desaxe.mechanism.closed.functions import closed_form
from desaxe.mechanism.closed.inverse import INVERSE
from desaxe.mechanism.closed.limits import ANGLES, LIMITS
from tests.compiler.languages.modules import module
from tests.compiler.languages.runners import RUNNERS, SLOW, caller
from tests.effort import cases
from tests.mechanism.closed.test_closed_forms import check_inverse, check_limits
from tests.mechanism.closed.truth import design

OUTPUTS = (*ANGLES, "margin", "link_margin", "first", "second")
INPUTS = ("Y", "ec", "AB", "BC")
LEAST = 1e-200  # m: XLA has no subnormal numbers, which are what rounding takes from smaller lengths


def program(branch):
    """Both closed forms as one program."""
    limits = keep_outputs(closed_form(LIMITS).program, OUTPUTS[:-2])
    inverse = keep_outputs(closed_form(INVERSE, branch=float(branch)).program, OUTPUTS[-2:])
    own = {line.name: f"limit_{line.name}" for line in limits.lines if line.name not in OUTPUTS}
    lines = (*renamed(limits, own).lines, *inverse.lines)
    return optimise(Program(INPUTS, lines, OUTPUTS, inverse.notes))


def designs(branch, number):
    """Random and border designs, each with a position that its slider has at some angle."""
    rng = random.Random(f"languages {branch}")
    while number:
        ec, AB, BC, _ = design(rng)
        if max(abs(ec), AB, BC) < LEAST:
            continue
        theta, Y = rng.uniform(-math.pi, math.pi), 0.0
        with mp.workdps(60):
            room = mp.mpf(BC) ** 2 - (mp.mpf(ec) + mp.mpf(AB) * mp.sin(theta)) ** 2
            if room > 0:
                Y = float(AB * mp.cos(theta) + branch * mp.sqrt(room))
        yield Y, ec, AB, BC
        number -= 1


@pytest.mark.sampled
@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(
    "to", [pytest.param(name, marks=[pytest.mark.thorough] if name in SLOW else []) for name in RUNNERS]
)
def test_limit_angles_and_the_inverse_in_every_language(to, branch, tmp_path):
    language = language_of(to)
    for file, text in language.files(module(program(branch))).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    rows = list(designs(branch, cases(60, 400, 50_000)))
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    result = caller(to, tmp_path / f"made{language.suffix}", INPUTS, OUTPUTS)(columns)
    for (Y, ec, AB, BC), *values in zip(rows, *result.values(), strict=True):
        own = dict(zip(OUTPUTS, map(float, values), strict=True))
        check_limits(own, ec, AB, BC)
        if Y and AB:
            with mp.workdps(60):
                check_inverse([own["first"], own["second"]], Y, *map(mp.mpf, (ec, AB, BC)), branch)
