"""Lazy imports: nothing heavy is loaded before it is needed, in a new process each."""

import subprocess
import sys

import pytest

HEAVY = ("numpy", "numba", "sympy", "xarray", "matplotlib", "pint", "desaxe.derive")
POINT = "theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0"
ARRAYS = "theta=numpy.array([1.0, 2.0]), ec=0.01, AB=0.125, BC=0.35, omega0=157.0"
KERNEL = "theta=numpy.linspace(0, 6, 3000), ec=0.01, AB=0.125, BC=0.35, omega0=157.0"


def loaded_by(code):
    """The heavy modules that are loaded after this code."""
    report = f"import sys; print(*(name for name in {HEAVY!r} if name in sys.modules))"
    command = [sys.executable, "-W", "error", "-c", f"{code}\n{report}"]
    return set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())


@pytest.mark.parametrize(
    "code",
    [
        "import desaxe",
        "import desaxe.generated",
        f"import desaxe\ndesaxe.evaluate('a_C', {POINT})",
        f"import desaxe\ndesaxe.evaluate(['Y', 'status', 'alpha_BC_wrt_ec_AB'], {POINT}, branch=-1)",
        "import desaxe\ndesaxe.evaluate('a_C_wrt_omega', theta=1, ec=0, AB=1, BC=3, omega=2)",
        "import desaxe\ndesaxe.quantities()",
    ],
)
def test_one_point_loads_nothing(code):
    assert loaded_by(code) == set()


@pytest.mark.parametrize(
    "call",
    [
        f"evaluate('a_C', {ARRAYS})",
        f"evaluate('a_C', {KERNEL})",
        f"grid('a_C', out=numpy.empty(3000), {KERNEL})",
        "function('a_C', ec=0.01, AB=0.125, BC=0.35, omega0=157.0)(numpy.ones(5))",
    ],
)
def test_arrays_load_numpy_and_no_numba(call):
    assert loaded_by(f"import numpy, desaxe\ndesaxe.{call}") == {"numpy"}


@pytest.mark.parametrize(
    ("text", "loads"), [("'10 mm'", False), ("'10 kg mm^2/g/m'", False), ("'0.4 thou'", True)]
)
def test_only_a_unit_beyond_the_table_loads_pint(text, loads):
    with_unit = POINT.replace("ec=0.01", f"ec={text}")
    assert ("pint" in loaded_by(f"import desaxe\ndesaxe.evaluate('a_C', {with_unit})")) is loads
