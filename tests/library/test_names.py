"""Names of sensitivities: taken apart and put together in one place."""

import pytest

import desaxe as dx
from desaxe.names import LOADS, ORDER, PARAMETERS, joined, parts, sensitivity


@pytest.mark.parametrize(
    ("name", "base", "parameters"),
    [
        ("a_C", "a_C", ()),
        ("a_C_wrt_ec", "a_C", ("ec",)),
        ("alpha_BC_wrt_BC_alpha", "alpha_BC", ("BC", "alpha")),
        ("V_C_wrt_omega0_omega0", "V_C", ("omega0", "omega0")),
        ("V_C_wrt_omega", "V_C", ("omega",)),
        ("F_B_X_wrt_F_X", "F_B_X", ("F_X",)),
        ("T_in_wrt_BC_m_rod", "T_in", ("BC", "m_rod")),
        ("Y_wrt_theta_nothing_known", "Y", ("theta", "nothing_known")),
    ],
)
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


def test_a_quantity_by_name():
    assert dx.quantities()["T_in"].unit == "N*m"
    assert dx.quantities()[0].name == "phi"
    with pytest.raises(ValueError, match="did you mean T_in"):
        dx.quantities()["torque"]
