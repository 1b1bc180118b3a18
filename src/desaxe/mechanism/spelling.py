"""Suggestions for an unknown name: similar spellings, and synonyms."""

from collections.abc import Iterable

from ..support.forks import IMPORTS

# Names here, of which the first that there is is meant: what people call them.
WORDS = {
    word: tuple(names.split())
    for names, words in {
        "ec": "eccentricity offset excentricity ecc e",
        "AB": "crank crank_length crank_radius radius r",
        "BC": "rod rod_length connecting_rod conrod coupler l",
        "theta theta0": "angle crank_angle theta",
        "omega0 omega_start": "speed crank_speed angular_speed angular_velocity rpm n w omega0 omega_0 omega",
        "alpha": "angular_acceleration",
        "a_C alpha": "acceleration a",
        "V_C": "velocity v",
        "j_C": "jerk j",
        "Y": "position displacement x",
        "phi": "rod_angle beta",
        "N_C": "side_force normal_force guide_force",
        "power_in": "power",
        "mu": "friction friction_coefficient",
        "m_crank": "crank_mass mass_crank",
        "m_rod": "rod_mass mass_rod",
        "m_slider": "slider_mass mass_slider piston_mass m_piston mass m",
        "F_Y": "force load",
        "g_Y": "gravity g",
        "torque T_in": "drive moment t_in torque",
        "t_end": "duration time",
    }.items()
    for word in words.split()
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
    result = spelled if key in by_case else [*same[:1], *spelled]
    return list(dict.fromkeys(result))[:most]


def did_you_mean(word: str, allowed: Iterable[str], most: int = 1) -> str:
    """The question "Did you mean ...?" with a space after it; empty if no name is similar."""
    *others, last = meant(word, allowed, most) or [""]
    return f"did you mean {', '.join(others)}{' or ' if others else ''}{last}? " if last else ""
