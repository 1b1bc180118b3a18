"""The true motion of a slider-crank under a torque, as Taylor series in time in ball arithmetic.

Nothing here is shared with the package. Positions of the masses come from the loop closure, their kinetic
energy gives M(theta) and H = M'/2, and M theta'' + H theta'^2 = Q is solved step by step by Picard's
iteration on power series (python-flint), to some 25 digits.
"""

from contextlib import contextmanager

from flint import arb, arb_series, ctx

ORDER = 28
MASSES = ("m_crank", "m_rod", "m_slider", "I_crank", "I_rod", "g_X", "g_Y", "F_Y")


def acceleration(design, torque, t, theta, omega):
    """theta'' as a power series in time, on the branch +1."""
    AB, BC, ec = (arb(design[name]) for name in ("AB", "BC", "ec"))
    m_crank, m_rod, m_slider, I_crank, I_rod, g_X, g_Y, F_Y = (arb(design.get(n, 0.0)) for n in MASSES)
    r_crank = arb(design["r_crank"]) if "r_crank" in design else AB / 2
    share = arb(design["r_rod"]) / BC if "r_rod" in design else arb(1) / 2
    s, c = theta.sin(), theta.cos()
    u = s * AB + ec
    S = (u * -u + BC * BC).sqrt()
    turn = c * AB / S
    turn_2 = (u * turn * turn - s * AB) / S
    Y, Y_2 = s * -AB - u * turn, c * -AB - c * AB * turn - u * turn_2
    x, y = c * (AB * (1 - share)), s * (-AB * (1 - share)) + Y * share
    x_2, y_2 = s * (-AB * (1 - share)), c * (-AB * (1 - share)) + Y_2 * share
    M = (x * x + y * y) * m_rod + turn * turn * I_rod + Y * Y * m_slider + (I_crank + m_crank * r_crank**2)
    H = (x * x_2 + y * y_2) * m_rod + turn * turn_2 * I_rod + Y * Y_2 * m_slider
    Q = Y * (F_Y + m_slider * g_Y) + (x * g_X + y * g_Y) * m_rod + (c * g_X - s * g_Y) * (m_crank * r_crank)
    return (Q + torque(t, theta, omega) - H * omega * omega) / M


def step(design, torque, t, theta, omega, h):
    """The state a time h later."""
    clock = arb_series([t, 1])
    angle, speed = arb_series([theta]), arb_series([omega])
    for _ in range(ORDER):
        speed = acceleration(design, torque, clock, angle, speed).integral() + omega
        angle = speed.integral() + theta
    return tuple(sum((x[k] * arb(h) ** k for k in range(ORDER)), arb(0)).mid() for x in (angle, speed))


def end(design, torque, theta, omega, t_end, steps):
    """theta and omega at t_end."""
    law = torque if callable(torque) else lambda t, theta, omega: arb_series([torque])
    theta, omega, h = arb(theta), arb(omega), arb(t_end) / steps
    for k in range(steps):
        theta, omega = step(design, law, h * k, theta, omega, h)
    return theta, omega


@contextmanager
def digits(prec):
    """Power series of the order of a step, with this many bits."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = prec, ORDER
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def true_end(design, torque, theta, omega, t_end, steps):
    """theta and omega at t_end, as floats; torque may be a number or a function of power series."""
    with digits(160):
        return tuple(map(float, end(design, torque, theta, omega, t_end, steps)))


def true_slopes(parameter, design, torque, theta0, omega_start, t_end, steps):
    """The derivatives of theta and omega at t_end by a parameter: central differences at 60 digits."""
    with digits(200):
        ends = []
        for side in (1, -1):
            given = {**design, "torque": torque, "theta0": theta0, "omega_start": omega_start}
            given[parameter] = arb(given.get(parameter, 0.0)) + side * arb(2) ** -36
            start = given.pop("torque"), given.pop("theta0"), given.pop("omega_start")
            ends.append(end(given, *start, t_end, steps))
        return tuple(float((a - b) * arb(2) ** 35) for a, b in zip(*ends, strict=True))
