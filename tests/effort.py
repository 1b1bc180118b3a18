"""The number of random cases of a test: few by default, many in a thorough run.

A test that asks is marked `sampled`, so that the thorough run repeats it; one that only the thorough run
can afford is marked `thorough`.
"""

import os

VARIABLE = "DESAXE_THOROUGH"


def cases(few: int, many: int, every: int = 0) -> int:
    """The number of cases to draw; `every` of them by DESAXE_THOROUGH=all, which takes hours."""
    asked = os.environ.get(VARIABLE)
    return max(many, every) if asked == "all" else many if asked else few
