"""Names of sensitivities: taken apart and put together in one place."""

import pytest

import desaxe as dx
from desaxe.mechanism.catalogue import has
from desaxe.mechanism.names import LOADS, ORDER, PARAMETERS, joined, parts, sensitivity


@pytest.mark.parametrize(
    ("name", "base", "parameters"),
    [
        ("a_C", "a_C", ()), ("a_C_wrt_ec", "a_C", ("ec",)), ("F_B_X_wrt_F_X", "F_B_X", ("F_X",)),
        ("alpha_BC_wrt_BC_alpha", "alpha_BC", ("BC", "alpha")), ("V_C_wrt_omega", "V_C", ("omega",)),
        ("V_C_wrt_omega0_omega0", "V_C", ("omega0", "omega0")),
        ("T_in_wrt_BC_m_rod", "T_in", ("BC", "m_rod")),
        ("Y_wrt_theta_nothing_known", "Y", ("theta", "nothing_known")),
    ],
)  # fmt: skip
def test_parts(name, base, parameters):
    assert parts(name) == (base, parameters)
    assert joined(base, parameters) == name


def test_parameters_stand_in_one_order():
    assert sensitivity("a_C", "BC", "theta") == "a_C_wrt_theta_BC"
    assert sensitivity("a_C_wrt_alpha", "ec") == "a_C_wrt_ec_alpha"
    assert sensitivity("T_in_wrt_mu", "BC") == "T_in_wrt_BC_mu"
    assert {*PARAMETERS, *LOADS} == set(ORDER) - {"omega"}


def test_the_catalogue_shows_itself_as_a_table():
    lines = repr(dx.quantities()).splitlines()
    assert len(lines) == 1 + len(dx.quantities())
    assert lines[0].split() == ["name", "unit", "meaning", "source"]
    assert next(line for line in lines if line.startswith("a_C ")).split()[1] == "m/s^2"


@pytest.mark.parametrize("name", ["F_Y", "ec", "V_outward", "theta_max_pressure_angle"])
def test_what_is_no_quantity_is_told_where_it_is(name):
    where = "`events`" if name in dx.events(ec=0.0, AB=1.0, BC=3.0) else "is an input"
    with pytest.raises(ValueError, match=f"^'{name}' is .*{where.removeprefix('is ')}"):
        dx.evaluate(name, theta=1.0, ec=0.0, AB=1.0, BC=3.0)


def test_the_catalogue_is_a_mapping_of_names():
    known = dx.quantities()
    assert ("a_C" in known, "a_D" in known, 0 in known, known.get("a_D")) == (True, False, False, None)
    assert (next(iter(known)), dict(known)["V_C"].unit, known["T_in"].unit) == ("phi", "m/s", "N*m")
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.1, "BC": 0.3, "omega0": 1.0}
    assert dx.evaluate([*known][:3], **point)
    for kind in (KeyError, ValueError):
        with pytest.raises(kind, match=r"^unknown quantity 'torque'; did you mean T_in"):
            known["torque"]


@pytest.mark.parametrize(
    ("name", "state", "there"),
    [
        ("a_C_wrt_omega0", False, True), ("a_C_wrt_omega0", True, False), ("a_C_wrt_omega", True, True),
        ("a_C_wrt_omega", False, False), ("T_in_wrt_theta_m_rod", False, False),
    ],
)  # fmt: skip
def test_whether_a_name_can_be_asked_for(name, state, there):
    assert has(name, state) is there


def test_a_peak_of_a_sensitivity_looks_for_no_similar_names(monkeypatch):
    def refuse(*_):
        raise AssertionError("suggestions that nobody reads")

    monkeypatch.setattr("difflib.get_close_matches", refuse)
    result = dx.peak("T_in_wrt_m_rod", ec=0.01, AB=0.1, BC=0.3, omega0=2.0, m_rod=1.0)
    assert result["status"] == 0
