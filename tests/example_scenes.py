"""A small scene, and the same with one key changed."""

import copy
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"
COMPACTOR, FEEDER = EXAMPLES / "compactor.toml", EXAMPLES / "feeder.toml"

SMALL = {
    "title": "small",
    "outputs": ["V_C", "a_C"],
    "mechanism": {"ec": [0, "50 mm"], "AB": "125 mm", "BC": 0.35},
    "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 5}, "omega0": "1500 rpm"},
}


def changed(path, value):
    """The small scene with one key set, or removed where the value is None."""
    data = copy.deepcopy(SMALL)
    *sections, last = path.split(".")
    place = data
    for section in sections:
        place = place.setdefault(section, {})
    if value is None:
        del place[last]
    else:
        place[last] = value
    return data
