"""The proof of the lines of a whole design: it tells each wrong line."""

import pytest

from desaxe.compiler.text import read_function
from desaxe.derive import closed
from desaxe.mechanism.closed.dead_centres import DEAD_CENTRES

WRONG = {
    "stroke_wrt_AB": ("outer_height + rod_over / inner_turning", "outer_height - rod_over / inner_turning"),
    "Y_inner": ("Y_inner = inner_branch * inner_height", "Y_inner = branch * inner_height"),
    "theta_outer": ("0.0 if offset == 0.0 else -offset, outer", "0.0 if offset == 0.0 else offset, outer"),
    "beta": ("stroke_in_unit, heights + offset * offset)", "stroke_in_unit, heights)"),
    "time_ratio": ("1.0 + 2.0 * fabs(beta)", "1.0 + fabs(beta)"),
    "min_pressure_angle": ("away - crank if crank < away", "away if crank < away"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_is_not_proved(name, monkeypatch):
    right, wrong = WRONG[name]
    assert right in DEAD_CENTRES
    monkeypatch.setattr(closed, "DESIGNS", ((1, 3, 9), (1, 9, 3)) if name == "Y_inner" else ((3, 1, 9),))
    with pytest.raises(ValueError, match=name):
        closed.prove(read_function(DEAD_CENTRES.replace(right, wrong)))
