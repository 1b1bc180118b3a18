"""Paper A: the names and the order of its listing, and Fig. 8."""

from tests.papers.proofs import proves

LISTING = {  # each line's name as printed, and the functions that it calls
    "omega": "",
    "delta": "",
    "phi": "",
    "Y": "phi",
    "V_B": "omega",
    "a_B": "omega",
    "omega_BC": "omega phi",
    "V_C": "omega omega_BC phi",
    "alpha_BC": "alpha_BC1 alpha_BC2 alpha_BC4 alpha_BC3",
    "alpha_BC1": "omega",
    "alpha_BC2": "",
    "alpha_BC3": "omega_BC phi",
    "alpha_BC4": "phi",
    "a_c": "a_c1 a_c2 a_c3 a_c4",
    "a_c1": "omega",
    "a_c2": "",
    "a_c3": "alpha_BC phi",
    "a_c4": "omega_BC phi",
}
FIG_8 = {1: ["omega"], 2: ["V_B", "a_B", "V_Bmag", "a_Bmag", "X"], 3: ["omega_BC", "V_c", "alpha_BC", "a_c"]}
NAMES = "a_c(...) and V_c(...) are defined or listed; a_C(60deg, 0.010, 0.125, 0.3) and V_C(...) are called"


@proves("A-listing-name", "typo", says=NAMES, cites="8")
def test_listing_defines_a_name_that_is_not_called():
    listed = {name for names in FIG_8.values() for name in names}
    assert {"a_C", "a_C1", "a_C2", "a_C3", "a_C4"}.isdisjoint(LISTING)
    assert {"a_c", "V_c"} <= listed
    assert "V_C" in LISTING


@proves("A-listing-order", "given")
def test_listing_is_not_in_order():
    names = list(LISTING)
    forward = [name for n, name in enumerate(names) if set(LISTING[name].split()) & set(names[n:])]
    assert forward == ["alpha_BC", "a_c"]
    assert len(names) - len(forward) == 16
    parts = [
        sorted(name for name in names if name.startswith(f"{one}") and name[-1] in "1234") for one in forward
    ]
    (first, last), (one, four) = ((names[0], names[-1]) for names in parts)
    return {"parts": f"{first} to {last} and {one} to {four}".replace("a_c", "a_C")}


@proves("A-fig8-X", "typo", cites="8")
def test_fig8_lists_functions_that_are_never_defined():
    defined, listed = set(LISTING), {name.replace("V_c", "V_C") for step in FIG_8.values() for name in step}
    assert listed - defined == {"V_Bmag", "a_Bmag", "X"}
    assert {name for name in defined - listed if name[-1] not in "1234"} == {"delta", "phi", "Y"}


@proves("A-fig8-steps", "correct", says="2 1 3", cites="1 2 3")
def test_fig8_steps_use_only_earlier_ones():
    step = {name.replace("V_c", "V_C"): number for number, names in FIG_8.items() for name in names}

    def needs(name):
        called = set(LISTING[name].split())
        return called.union(*map(needs, called))

    assert needs("V_B") == needs("a_B") == {"omega"}
    defined = [name for name in step if name in LISTING]
    assert all(step[other] <= step[name] for name in defined for other in needs(name) & set(step))
