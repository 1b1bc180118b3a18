"""C under loads: NULL, tables from points, `alpha`, `step`, and no stray byte."""

import ctypes
import math
from functools import cache

import numpy as np
import pytest

import desaxe as dx
from tests.compiler.languages.runners import in_c
from tests.compiler.languages.tools import STRICT, library, pointer, run, tool
from tests.effort import cases
from tests.loads.module_loads import SHAPES, load, scene, wrong_tables

DOUBLE = ctypes.c_double
STILL = {"ec": 0.01, "AB": 0.035, "BC": 0.064, "m_slider": 0.8, "I_crank": 2e-4}
OPEN = (0.5, 0.01, 0.035, 2.0)  # theta, ec, AB, omega0
ALPHA, STEP = 2, 3


def written(kind, shape="kinked", **more):
    """A scene in a given state whose crank has inertia, too."""
    content = scene(load(kind, shape), **more)
    content["motion"] = {"theta": [0.0, 1.0], "omega": [1.0, 2.0]}
    content["mechanism"] = {name: STILL[name] for name in ("ec", "AB", "BC")}
    content["masses"] = {"m_slider": 0.8, "I_crank": 2e-4}
    return content


class Press:
    """A module whose tables are arguments, moved under one of them."""

    def __init__(self, folder, kind, **more):
        place = dx.compile(written(kind, **more), folder / "press", to="c", tables="arguments")
        self.loaded = library(place / "press.c", options=("-O1",))
        self.row = pointer(np.array([math.nan, math.nan]))

    def alpha(self, table, torque, theta, omega):
        found, state = DOUBLE(7.0), map(DOUBLE, (torque, theta, omega))
        status = self.loaded.press_alpha(*state, self.row, ctypes.byref(found), *in_c({"F_Y": table}))
        return status, found.value

    def step(self, table, h, torque, theta, omega):
        state = DOUBLE(theta), DOUBLE(omega)
        given = DOUBLE(h), DOUBLE(torque), *map(ctypes.byref, state), self.row
        return self.loaded.press_step(*given, *in_c({"F_Y": table})), *(each.value for each in state)

    def run(self, table, t_end, steps, torque, theta, omega):
        for _ in range(steps):
            status, theta, omega = self.step(table, t_end / steps, torque, theta, omega)
            assert status == 0
        return theta, omega


# One kind with all that there is by default; a thorough run has two more.
ONE = "outer both ways"
SOME = [ONE, *(pytest.param(kind, marks=pytest.mark.thorough) for kind in ("theta", "Y"))]


@pytest.fixture(scope="module")
def presses(tmp_path_factory):
    """A press of a kind, compiled once."""
    return cache(lambda kind: Press(tmp_path_factory.mktemp("press"), kind))


@pytest.mark.sampled
@pytest.mark.parametrize("kind", SOME)
def test_the_torque_of_the_acceleration_is_the_torque(kind, presses):
    """`T_in` under the table gives it back: virtual work, not the formula of `alpha`."""
    press, rng = presses(kind), np.random.default_rng(36)
    for shape in SHAPES:
        one = load(kind, shape, 0.01)
        for _ in range(cases(20, 200)):
            torque, theta, omega = rng.uniform((-5, -9, -60), (5, 9, 60))
            status, alpha = press.alpha(one.arrays(), torque, theta, omega)
            assert status == 0
            found = dx.evaluate("T_in", theta=theta, omega=omega, alpha=alpha, **STILL, F_Y=one)
            assert found == pytest.approx(torque, abs=1e-10 * (1 + abs(alpha)))


@pytest.mark.parametrize(
    ("kind", "shape"), [(ONE, "jumping"), pytest.param("theta", "smooth", marks=pytest.mark.thorough)]
)
def test_steps_follow_simulate(kind, shape, presses):
    """Of order 4 where the table is smooth; across jumps and the change at dead centres of order 1."""
    press, one = presses(kind), load(kind, shape, 0.02)
    found = dx.simulate(torque=0.4, t_end=0.2, theta0=0.3, omega_start=40.0, **STILL, F_Y=one, rtol=1e-12)
    wanted = np.array([found["theta"][-1], found["omega"][-1]])
    counts = (400, 800, 1600)
    errors = [np.abs(press.run(one.arrays(), 0.2, n, 0.4, 0.3, 40.0) - wanted) for n in counts]
    if shape == "smooth":
        assert (errors[0] > 7 * errors[1]).all()  # the third derivative of a spline jumps
        assert (errors[2] < 4e-6 * np.abs(wanted)).all()
    else:
        assert (errors[2] < 2e-3 * np.abs(wanted)).all()


def test_a_crank_at_rest_goes_the_way_that_the_load_lets_it(presses):
    """Against the slider both ways, a load holds it, as friction does, until the torque is enough."""
    press = presses(ONE)
    one = dx.over_stroke([0.0, 0.1], [-50.0, -50.0], [50.0, 50.0], dead_centre="outer")
    assert press.step(one.arrays(), 1e-3, 0.1, 1.0, 0.0) == (0, 1.0, 0.0)
    assert press.alpha(one.arrays(), 0.1, 1.0, 0.0) == (0, 0.0)
    held = dx.evaluate("T_in", theta=1.0, omega=1.0, alpha=0.0, **STILL, F_Y=50.0)  # inward
    assert held > 0.1
    status, alpha = press.alpha(one.arrays(), 2 * held, 1.0, 0.0)
    assert (status, alpha > 0.0) == (0, True)
    back = dx.evaluate("T_in", theta=1.0, omega=1.0, alpha=0.0, **STILL, F_Y=-50.0)
    assert press.alpha(one.arrays(), 2 * back, 1.0, 0.0)[1] < 0.0


@pytest.mark.parametrize("kind", SOME)
def test_no_table_leaves_the_state_and_null_is_none(kind, presses):
    press, one = presses(kind), load(kind, "kinked")
    for name, table in wrong_tables(one).items():
        assert press.step(table, 1e-3, 1.0, 0.5, 2.0) == (4, 0.5, 2.0), name
        status, alpha = press.alpha(table, 1.0, 0.5, 2.0)
        assert (status, math.isnan(alpha)) == (4, True), name
    x, c, n = in_c({"F_Y": one.arrays()})
    point, out = press.loaded.press_point, np.zeros(7)
    given = pointer(np.array([0.5, 2.0])), pointer(out)
    assert point(*given, x, c, n) == 0
    assert np.isfinite(out).all()
    for wrong in ((None, c, n), (x, None, n), (x, c, ctypes.c_int64(0)), (x, c, ctypes.c_int64(-5))):
        assert point(*given, *wrong) == 4
        assert np.isnan(out[0])
        assert np.isfinite(out[5])  # Y


@pytest.mark.parametrize(("kind", "ways"), [("Y", 1), (ONE, 2)])
def test_the_header_says_how_long_a_table_is(kind, ways, tmp_path):
    place = dx.compile(written(kind), tmp_path / "press", to="c", tables="arguments")
    said = " ".join((place / "press.h").read_text(encoding="utf-8").split())
    assert f"c has room for {4 * ways}*(n + 1) numbers" in said
    assert ("a NULL (inward, too)" in said) == (ways == 2)


@pytest.mark.parametrize("kind", SOME)
def test_tables_from_points_have_the_digits_of_python(kind, presses):
    press, rng = presses(kind), np.random.default_rng(7)
    fill = press.loaded.press_F_Y_table
    for number in range(20):
        n = int(rng.integers(2, 9))
        x, forces, back = np.sort(rng.uniform(0.0, 0.06, n)), rng.uniform(-9, 9, n), rng.uniform(-9, 9, n)
        shape = "step" if number % 2 else "linear"
        ways = [forces, back] if "both" in kind else [forces]
        if kind == "theta":
            one = dx.over_theta(50 * x, forces, shape)
            x = 50 * x
        elif kind == "Y":
            one = dx.over_Y(x, forces, None, shape)
        else:
            one = dx.over_stroke(x, forces, back, shape, dead_centre="outer")
        wanted = np.array(one.arrays().coefficients)[: 4 * (n + 1) * len(ways)]
        found = np.full(wanted.size, 7.0)
        given = [pointer(x), *map(pointer, ways), number % 2, pointer(found)]
        assert fill(ctypes.c_int64(n), *given) == 0
        np.testing.assert_array_equal(found, wanted)
        assert fill(ctypes.c_int64(1), *given) == 4
        assert fill(ctypes.c_int64(n), None, *given[1:]) == 4
        assert fill(ctypes.c_int64(n), pointer(x[::-1].copy()), *given[1:]) == 4


MAIN = """
#include "press.h"
#include <stdlib.h>
#include <string.h>
static double *own(const double *from, size_t n) {{ /* of exactly this size, for the sanitizer */
  double *found = malloc(n ? n * sizeof *found : 1);
  if (n) memcpy(found, from, n * sizeof *found);
  return found;
}}
static const double xs[] = {{{x}}}, cs[] = {{{c}}};
int main(void) {{
  int bad = 0;
  for (int64_t n = -1; n <= {n}; n++) {{
    const size_t used = n > 0 ? (size_t)n : 0;
    double *x = own(xs, used), *c = own(cs, n > 1 ? {ways} * 4 * (used + 1) : 0);
    for (int k = 0; k < 400; k++) {{
      double in[2] = {{0.05 * k - 10.0, k % 3 - 1.0}}, out[7], alpha, theta = in[0], omega = in[1];
      const double *const columns[2] = {{&in[0], &in[1]}};
      double *const outs[7] = {{out, out + 1, out + 2, out + 3, out + 4, out + 5, out + 6}};
      bad += press_point(in, out, x, c, n) != (n < 2 ? 4 : 0);
      press_array(1, columns, outs, x, c, n);
      bad += press_alpha(0.1, theta, omega, in, &alpha, x, c, n) != (n < 2 ? 4 : 0);
      bad += press_step(1e-4, 0.1, &theta, &omega, in, x, c, n) != (n < 2 ? 4 : 0);
    }}
    free(x);
    free(c);
  }}
  return bad != 0;
}}
"""


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["theta", "inner both ways"])
def test_the_sanitizers_find_nothing(kind, tmp_path):
    """Memory of exactly the sizes that the header asks for, every number of knots."""
    one = load(kind, "jumping", 1e-3)
    place = dx.compile(written(kind), tmp_path / "press", to="c", tables="arguments")
    x, c = one.arrays()
    texts = {
        "x": ", ".join(map(repr, x)),
        "c": ", ".join(map(repr, c)),
        "n": len(x),
        "ways": 1 + ("both" in kind),
    }
    # Every number of knots has room for its own pieces, whatever they mean.
    (place / "main.c").write_text(MAIN.format(**texts))
    flags = [*STRICT, "-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    run(tool("gcc"), *flags, place / "main.c", place / "press.c", "-o", place / "main", "-lm")
    run(place / "main")
