"""Every language has the coverage set right: each operation, each way to nest two."""

import numpy as np
import pytest

from desaxe.compiler.languages import language_of
from desaxe.compiler.passes.slicing import keep_outputs
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import written, wrong_names
from tests.compiler.languages.runners import RUNNERS, SLOW, caller


@pytest.mark.parametrize(
    "language", [pytest.param(name, marks=pytest.mark.thorough if name in SLOW else ()) for name in RUNNERS]
)
def test_the_coverage_set_against_exact(language, tmp_path):
    program = keep_outputs(coverage(), NAMES)
    place = written(language_of(language), program, tmp_path)
    columns = [np.array([point[name] for point in POINTS]) for name in program.inputs]
    result = caller(language, place, program.inputs, NAMES)(columns)
    rows = zip(*(np.broadcast_to(result[name], len(POINTS)) for name in NAMES), strict=True)
    for point, row in zip(POINTS, rows, strict=True):
        assert not wrong_names(dict(zip(NAMES, map(float, row), strict=True)), point), point
