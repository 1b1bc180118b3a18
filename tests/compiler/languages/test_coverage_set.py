"""Every language has the coverage set right: each operation, each way to nest two."""

import numpy as np
import pytest

from desaxe.compiler.languages import language_of
from desaxe.compiler.passes.slicing import keep_outputs
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import written, wrong_names
from tests.compiler.languages.runners import RUNNERS, SLOW, caller

CASES = [*((name, True) for name in RUNNERS), ("c", False)]


@pytest.mark.parametrize(
    ("language", "libm"),
    [pytest.param(*case, marks=pytest.mark.thorough if case[0] in SLOW else ()) for case in CASES],
)
def test_the_coverage_set_against_exact(language, libm, tmp_path):
    names = [name for name in NAMES if name != "grown" or libm]
    program = keep_outputs(coverage(), names)
    options = () if libm else (True,)
    place = written(language_of(language), program, tmp_path, *options)
    columns = [np.array([point[name] for point in POINTS]) for name in program.inputs]
    found = caller(language, place, program.inputs, names, libm)(columns)
    rows = zip(*(np.broadcast_to(found[name], len(POINTS)) for name in names), strict=True)
    for point, row in zip(POINTS, rows, strict=True):
        assert not wrong_names(dict(zip(names, map(float, row), strict=True)), point), point


def test_what_bare_metal_lacks_is_refused_by_name(tmp_path):
    with pytest.raises(ValueError, match="without libm has no exp, log, pow"):
        written(language_of("c"), keep_outputs(coverage(), ["grown"]), tmp_path, True)
