"""The choice of the tier, and the accuracy of the NumPy tier."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.program import Variant
from desaxe.runtime import tiers
from desaxe.runtime.kernels import KernelKey

SIZES = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
KEY = KernelKey(("V_C",), Variant(), (("branch", 1.0),), (("theta", 0),), 1)


@pytest.fixture
def cold(cold, monkeypatch):
    """A process without kernels in which, as outside of tests, NumPy comes first."""
    monkeypatch.setattr(tiers, "NUMPY_PAYS", 250_000)


def test_few_points_then_numpy_once_then_a_kernel(cold):
    assert tiers.tier_of(KEY, 100, True) == "interpreted"
    other = KEY._replace(names=("a_C",))
    assert [tiers.tier_of(other, 100_000, True) for _ in range(2)] == ["numpy", "compiled"]
    assert tiers.tier_of(KEY._replace(names=("Y",)), 300_000, True) == "compiled"
    assert tiers.tier_of(KEY._replace(names=("s",)), 100_000) == "compiled"


def test_points_asked_for_again_and_again_are_compiled(cold):
    assert [tiers.tier_of(KEY, 720, True) for _ in range(3)] == ["interpreted", "interpreted", "compiled"]


def test_looking_ahead_counts_nothing(cold):
    assert [tiers.tier_ahead(KEY, 1_500) for _ in range(2)] == ["interpreted"] * 2


@pytest.mark.parametrize("name", tiers.TIERS)
def test_a_tier_can_be_forced(monkeypatch, name):
    monkeypatch.setenv(tiers.VARIABLE, name)
    assert tiers.tier_of(KEY, 5, True) == name
    assert np.isfinite(dx.evaluate("V_C", theta=np.array([0.1, 0.2]), ec=0.0, **SIZES)).all()


def test_an_unknown_tier_is_refused(monkeypatch):
    monkeypatch.setenv(tiers.VARIABLE, "fortran")
    with pytest.raises(
        ValueError, match="DESAXE_TIER = 'fortran': it is one of interpreted, numpy, compiled"
    ):
        tiers.tier_of(KEY, 5)


def points():
    """Designs of all sorts: wide margins, change points, some that cannot turn, some bad."""
    rng = np.random.default_rng(3)
    size = 20_000
    theta, ec = rng.uniform(-7.0, 7.0, size), rng.uniform(-0.05, 0.05, size)
    AB, share = rng.uniform(0.1, 0.15, size), rng.random(size)
    BC = np.where(share < 0.5, rng.uniform(0.3, 0.4, size), (AB + np.abs(ec)) * rng.uniform(0.9, 1.1, size))
    close = share > 0.9
    theta[close] = math.pi / 2 * np.sign(ec[close]) + 10.0 ** rng.uniform(-9, -1, close.sum())
    BC[close] = AB[close] + np.abs(ec[close])
    theta[:3], AB[3], BC[4], ec[5] = (np.nan, np.inf, 1e12), -1.0, 0.0, np.nan
    return {"theta": theta, "ec": ec, "AB": AB, "BC": BC, "omega0": 157.08}


@pytest.mark.thorough
@pytest.mark.parametrize("accuracy", ["standard", "extended"])
def test_numpy_keeps_what_a_kernel_does(monkeypatch, accuracy):
    given = {name: value if np.ndim(value) == 0 else value[::10] for name, value in points().items()}
    names = ["Y", "V_C", "a_C", "a_C_wrt_ec", "status"]
    found = {}
    for tier in ("numpy", "compiled"):
        monkeypatch.setenv(tiers.VARIABLE, tier)
        found[tier] = dx.evaluate(names, **given, accuracy=accuracy)
    exact = dx.evaluate(names, **given, accuracy="extended")
    assert np.array_equal(found["numpy"]["status"], found["compiled"]["status"])
    for name in names[:-1]:
        errors = {}
        for tier, values in found.items():
            assert np.array_equal(np.isnan(values[name]), np.isnan(exact[name]))
            with np.errstate(all="ignore"):
                errors[tier] = np.abs(values[name] - exact[name]) / np.abs(exact[name])
        bad = errors["numpy"] > 4.0 * errors["compiled"] + 1e-14
        assert np.mean(bad[np.isfinite(exact[name])]) < 0.01
        assert np.nanmax(errors["numpy"]) <= 10.0 * np.nanmax(errors["compiled"]) + 1e-14


def test_a_first_call_of_a_process_needs_no_compiler(tmp_path):
    code = """
import sys
import numpy as np
import desaxe as dx
theta = np.linspace(-7.0, 7.0, 100_000)
ec = np.linspace(0.0, 0.2, theta.size)
values = dx.evaluate(["V_C", "status"], theta=theta, ec=ec, AB=0.1, BC=0.25, omega0=1.0)
assert np.isfinite(values["V_C"]).sum() == (values["status"] == 0).sum() > 50_000
sys.exit("numba" in sys.modules)
"""
    environment = {**os.environ, "DESAXE_CACHE_DIR": str(tmp_path)}
    assert subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0
