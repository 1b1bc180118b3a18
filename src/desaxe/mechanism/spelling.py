"""Suggestions for an unknown name: similar spellings, and synonyms."""

from collections.abc import Iterable

from ..support.forks import IMPORTS

# What people call inputs and quantities -> their names here; the first that there is, is meant.
WORDS = {
    **dict.fromkeys(("eccentricity", "offset", "excentricity", "ecc", "e"), ("ec",)),
    **dict.fromkeys(("crank", "crank_length", "crank_radius", "radius", "r"), ("AB",)),
    **dict.fromkeys(("rod", "rod_length", "connecting_rod", "conrod", "coupler", "l"), ("BC",)),
    **dict.fromkeys(("angle", "crank_angle", "theta"), ("theta", "theta0")),
    **dict.fromkeys(
        (
            "speed",
            "crank_speed",
            "angular_speed",
            "angular_velocity",
            "rpm",
            "n",
            "w",
            "omega0",
            "omega_0",
            "omega",
        ),
        ("omega0", "omega_start"),
    ),
    "angular_acceleration": ("alpha",),
    "acceleration": ("a_C", "alpha"),
    **dict.fromkeys(("velocity", "v"), ("V_C",)),
    "a": ("a_C", "alpha"),
    **dict.fromkeys(("jerk", "j"), ("j_C",)),
    **dict.fromkeys(("position", "displacement", "x"), ("Y",)),
    **dict.fromkeys(("rod_angle", "beta"), ("phi",)),
    **dict.fromkeys(("side_force", "normal_force", "guide_force"), ("N_C",)),
    "power": ("power_in",),
    **dict.fromkeys(("friction", "friction_coefficient"), ("mu",)),
    **dict.fromkeys(("crank_mass", "mass_crank"), ("m_crank",)),
    **dict.fromkeys(("rod_mass", "mass_rod"), ("m_rod",)),
    **dict.fromkeys(("slider_mass", "mass_slider", "piston_mass", "m_piston", "mass", "m"), ("m_slider",)),
    **dict.fromkeys(("force", "load"), ("F_Y",)),
    **dict.fromkeys(("gravity", "g"), ("g_Y",)),
    **dict.fromkeys(("drive", "moment", "t_in", "torque"), ("torque", "T_in")),
    **dict.fromkeys(("duration", "time"), ("t_end",)),
}


def meant(word: str, allowed: Iterable[str], most: int = 1) -> list[str]:
    """The allowed names that are similar to an unknown one, the likeliest first; empty if none is.

    Upper and lower case, which people mix up, count as the same.
    """
    with IMPORTS:
        from difflib import get_close_matches

    by_case: dict[str, list[str]] = {}
    for name in allowed:
        by_case.setdefault(name.lower(), []).append(name)
    if not isinstance(word, str):
        return []
    key = word.lower()
    spelled = [name for near in get_close_matches(key, by_case, most, 0.6) for name in by_case[near]]
    same = [name for name in WORDS.get(key, ()) if name in by_case.get(name.lower(), ())]
    found = spelled if key in by_case else [*same[:1], *spelled]
    return list(dict.fromkeys(found))[:most]


def did_you_mean(word: str, allowed: Iterable[str], most: int = 1) -> str:
    """The question "Did you mean ...?" with a space after it; empty if no name is similar."""
    *others, last = meant(word, allowed, most) or [""]
    return f"did you mean {', '.join(others)}{' or ' if others else ''}{last}? " if last else ""
