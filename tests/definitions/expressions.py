"""Expressions for the tests, each with the same in mpmath, and their values and derivatives from the oracle.

The oracle knows the names that an expression uses, and their derivatives; the expression of their Taylor
polynomials is differentiated by mpmath's differences. Nothing of the Program is used.
"""

from contextlib import contextmanager

import mpmath
from mpmath import mp

import desaxe as dx
from desaxe.mechanism.own import definitions
from desaxe.oracle.force_truth import OTHERS, truth

HALVES = {"r_crank": "AB", "r_rod": "BC"}


@contextmanager
def defined(name, expression, **more):
    """A definition for a while."""
    dx.define(name, expression, **more)
    try:
        yield name
    finally:
        if name in definitions():
            dx.undefine(name)


class Expression:
    """A text, the same as a function of mpmath numbers, and the names it uses."""

    def __init__(self, text, function, names, **constants):
        self.text, self.function, self.names, self.constants = text, function, names, constants

    def exact(self, point, *parameters):
        """The value, or the partial derivative by up to two parameters, to many digits."""
        with mp.workdps(60):
            if not parameters:
                return self.function(*(leaf(name, point) for name in self.names))
            moved = [taylor(name, point, parameters) for name in self.names]
            if len(parameters) == 1:
                return mp.diff(lambda t: self.function(*(m(t, 0) for m in moved)), 0, h=mpmath.mpf(10) ** -20)
            return mp.diff(
                lambda t, r: self.function(*(m(t, r) for m in moved)),
                (0, 0),
                (1, 1),
                h=mpmath.mpf(10) ** -15,
            )


def leaf(name, point, *parameters):
    """A name, an input or a derivative of either."""
    if name in point or name in HALVES or name in OTHERS:
        base = mpmath.mpf(point[name]) if name in point else _half(name, point)
        if not parameters:
            return base
        (parameter, *others) = parameters
        half = name not in point and HALVES.get(name) == parameter
        return mpmath.mpf(0) if others else mpmath.mpf(name == parameter) + (0.5 if half else 0)
    joint = "_" if "_wrt_" in name else "_wrt_"
    called = name + (joint + "_".join(parameters) if parameters else "")
    base = name.partition("_wrt_")[0]
    if any(p in OTHERS for p in parameters) and not depends(base):
        return mpmath.mpf(0)
    return truth(called, **point)


def depends(base):
    """True if a quantity depends on masses and loads."""
    return f"{base}_wrt_m_rod" in dx.quantities()


def _half(name, point):
    return mpmath.mpf(point[HALVES[name]]) / 2 if name in HALVES else mpmath.mpf(0)


def taylor(name, point, parameters):
    """The name as a polynomial in small changes t and r of one or two parameters."""
    value = leaf(name, point)
    first = leaf(name, point, parameters[0])
    if len(parameters) == 1:
        return lambda t, r: value + first * t
    second, both = leaf(name, point, parameters[1]), leaf(name, point, *parameters)
    return lambda t, r: value + first * t + second * r + both * t * r


GENERIC = {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 157.0, "alpha": -40.0}
BODIES = {"m_crank": 1.5, "m_rod": 0.7, "m_slider": 0.9, "I_crank": 0.02, "I_rod": 0.01, "mu": 0.1}
BODIES |= {"F_Y": -50.0, "g_Y": -9.8}

EXPRESSIONS = {
    "shoe_power": Expression(
        "f * abs(N_C * V_C)", lambda n, v: mpmath.mpf(0.08) * abs(n * v), ("N_C", "V_C"), f=0.08
    ),
    "bearing": Expression(
        "hypot(F_B_X, F_B_Y) / (d * l)",
        lambda x, y: mp.hypot(x, y) / (mpmath.mpf(0.03) * mpmath.mpf(0.04)),
        ("F_B_X", "F_B_Y"),
        d="30 mm",
        l="4 cm",
    ),
    "energy": Expression(
        "0.5*m_slider*V_C**2 + kinetic_energy",
        lambda m, v, e: m * v * v / 2 + e,
        ("m_slider", "V_C", "kinetic_energy"),
    ),
    "powers": Expression(
        "sqrt(1 - AB/BC) * abs(a_C/AB/omega0**2)**1.5 * (Y/BC)**-2 * abs(V_C/(AB*omega0))**0.3",
        lambda a, b, c, w, y, v: (
            mp.sqrt(1 - a / b)
            * mp.power(abs(c / a / w**2), mpmath.mpf("1.5"))
            * (b / y) ** 2
            * mp.power(abs(v / (a * w)), mpmath.mpf(0.3))
        ),
        ("AB", "BC", "a_C", "omega0", "Y", "V_C"),
    ),
    "waves": Expression(
        "sin(2*theta) + cos(phi)*tan(theta) - atan2(V_B_X, V_B_Y) + exp(-phi**2)*log(2 + phi)",
        lambda t, p, x, y: (
            mp.sin(2 * t) + mp.cos(p) * mp.tan(t) - mp.atan2(x, y) + mp.exp(-p * p) * mp.log(2 + p)
        ),
        ("theta", "phi", "V_B_X", "V_B_Y"),
    ),
    "grows": Expression("(Y/AB)**(BC/AB)", lambda y, a, b: mp.power(y / a, b / a), ("Y", "AB", "BC")),
    "choice": Expression(
        "where(V_C > 0, max(V_C, 0), min(V_C, 2*V_B_X, V_B_Y))",
        lambda v, x, y: v if v > 0 else min(v, 2 * x, y),
        ("V_C", "V_B_X", "V_B_Y"),
    ),
    "of_slope": Expression(
        "V_C_wrt_ec * ec + T_in_wrt_ec * ec / (omega0 * m_rod * BC)",
        lambda v, e, t, w, m, b: v * e + t * e / (w * m * b),
        ("V_C_wrt_ec", "ec", "T_in_wrt_ec", "omega0", "m_rod", "BC"),
    ),
    "centre": Expression(
        "m_rod * r_rod**2 + I_rod", lambda m, r, i: m * r * r + i, ("m_rod", "r_rod", "I_rod")
    ),
    "near": Expression(
        "margin / BC + a_C / 1000 / AB / omega**2",
        lambda m, b, a, r, w: m / b + a / 1000 / r / w**2,
        ("margin", "BC", "a_C", "AB", "omega"),
    ),
}
