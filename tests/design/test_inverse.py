"""The slider-driven problem: there and back, and the two flat triangles."""

import math

import numpy as np
import pytest
import xarray as xr
from mpmath import mp, mpf

import desaxe as dx

LENGTHS = {"ec": 0.05, "AB": 0.125, "BC": 0.35}


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("AB", [0.125, 0.5])
def test_there_and_back(branch, AB):
    lengths = {"ec": -0.07, "AB": AB, "BC": 0.35}
    theta = np.linspace(-3.1, 3.1, 400)
    Y, status = dx.evaluate(["Y", "status"], theta=theta, branch=branch, **lengths).values()
    theta, Y = theta[status == 0], Y[status == 0]
    result = dx.inverse(Y=Y, branch=branch, **lengths)
    nearest = np.nanmin(np.abs(result["theta"] - theta[:, None]), axis=1)
    assert nearest.max() < 1e-7
    back = dx.evaluate("Y", theta=result["theta"], branch=branch, **lengths)
    np.testing.assert_allclose(
        back[np.isfinite(back)], np.broadcast_to(Y[:, None], back.shape)[np.isfinite(back)], atol=1e-14
    )


def test_rates_are_those_of_the_crank():
    theta = np.array([0.4, 2.0, -1.2])
    motion = dx.evaluate(["Y", "V_C", "a_C"], theta=theta, omega=7.0, alpha=-3.0, **LENGTHS)
    result = dx.inverse(**motion, **LENGTHS)
    own = np.abs(result["theta"] - theta[:, None]) < 1e-9
    np.testing.assert_allclose(result["omega"][own], 7.0, rtol=1e-12)
    np.testing.assert_allclose(result["alpha"][own], -3.0, rtol=1e-10)


def test_branches_share_no_solution():
    up = dx.inverse(Y=0.3, branch=1, ec=0.05, AB=0.5, BC=0.35)["theta"]
    down = dx.inverse(Y=0.3, branch=-1, ec=0.05, AB=0.5, BC=0.35)["theta"]
    angles = [a for a in (*up, *down) if math.isfinite(a)]
    assert len(angles) == 2
    assert abs(angles[0] - angles[1]) > 0.1


def test_status():
    result = dx.inverse(Y=[0.3, 0.9, math.nan, 0.475], ec=0.0, AB=0.125, BC=0.35, V_C=1.0)
    assert result["status"].tolist() == [0, 1, 4, 2]
    assert np.isnan(result["theta"][1]).all()
    assert result["theta"][3, 0] == 0.0
    assert np.isnan(result["omega"][3]).all()


def test_shapes():
    result = dx.inverse(Y=np.full((3, 1), 0.3), ec=[0.0, 0.1], AB=0.125, BC=0.35)
    assert result["theta"].shape == (3, 2, 2)
    assert result["status"].shape == (3, 2)
    assert isinstance(dx.inverse(Y=0.3, **LENGTHS)["status"], int)
    assert (
        dx.inverse(Y="300 mm", **LENGTHS)["theta"].tolist() == dx.inverse(Y=0.3, **LENGTHS)["theta"].tolist()
    )


def test_units_of_arrays():
    """A labelled array says its unit, and so may each text of a list."""
    lengths = {"ec": 0.01, "AB": 0.05, "BC": 0.2}
    expected = dx.inverse(Y=[0.19, 0.21], V_C=[1.0, -2.0], **lengths)
    labelled = xr.DataArray([190.0, 210.0], dims="k", attrs={"units": "mm"})
    for given in (labelled, ["190 mm", "0.21 m"]):
        result = dx.inverse(Y=given, V_C=["1 m/s", "-200 cm/s"], **lengths)
        for name, values in expected.items():
            np.testing.assert_allclose(result[name], values, rtol=1e-12)


@pytest.mark.parametrize("branch", [1, -1])
def test_a_distance_from_the_outer_dead_centre(branch):
    """Angles to rounding however near it is: the roots of the loop closure at 40 digits."""
    draw = np.random.default_rng(3)
    AB = draw.uniform(0.05, 0.2, 40)
    BC = AB * draw.uniform(1.2, 4.0, 40)
    ec = draw.uniform(-0.9, 0.9, 40) * (BC - AB)
    s = dx.events(ec=ec, AB=AB, BC=BC, branch=branch)["stroke"] * 10.0 ** draw.uniform(-14.0, -0.01, 40)
    result = dx.inverse(s=s, ec=ec, AB=AB, BC=BC, branch=branch)
    assert not result["status"].any()
    with mp.workdps(40):
        for k, two in enumerate(result["theta"].tolist()):
            crank, rod, offset = mpf(float(AB[k])), mpf(float(BC[k])), mpf(float(ec[k]))

            def distance(theta, crank=crank, rod=rod, offset=offset):
                along = mp.sqrt(rod**2 - (crank * mp.sin(theta) + offset) ** 2)
                return mp.sqrt((crank + rod) ** 2 - offset**2) - branch * crank * mp.cos(theta) - along

            for theta in two:
                exact = mp.findroot(lambda x, d=distance, k=k: d(x) - mpf(float(s[k])), mpf(theta))
                assert abs(exact - theta) < 3e-15
            assert two[0] < two[1]


def test_distances_at_the_ends_of_the_stroke():
    lengths = {"ec": 0.01, "AB": 0.1, "BC": 0.3}
    ends = dx.events(**lengths)
    result = dx.inverse(s=[0.0, 0.1, 0.3], V_C=1.0, **lengths)
    assert result["status"].tolist() == [2, 0, 1]
    assert result["theta"][0, 0] == ends["theta_outer"]
    assert np.isnan(result["omega"][0]).all()
    machine = dx.Machine(units="mm, deg", ec=10, AB=100, BC=300)
    there = machine.evaluate("s", theta=machine.inverse(s=5)["theta"])
    assert there == pytest.approx([5.0, 5.0], rel=1e-13)
    with pytest.raises(TypeError, match="Y and s both"):
        dx.inverse(s=0.1, Y=0.3, **lengths)
    with pytest.raises(TypeError, match="Y or s"):
        dx.inverse(**lengths)
