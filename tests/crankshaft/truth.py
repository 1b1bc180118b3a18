"""Crankshafts to 60 digits: places of all masses in the frame of the shaft, their momentum and energy.

Nothing is taken from desaxe: a slider is three bodies whose places follow from the loop closure along an axis
that is turned by its bank; rates are by differences with a third of the digits.
"""

from typing import Any, NamedTuple

import mpmath
import numpy as np
from mpmath import mp, mpf

DIGITS = 60


class TrueSlider(NamedTuple):
    """A slider: its inputs by name, its angles and its distance from the middle."""

    inputs: dict[str, Any]
    phase: Any
    bank: Any
    position: Any = 0
    load: Any = None  # force along the slider's axis over theta - phase - bank - 2 pi turns
    turns: int = 0

    def number(self, name, default=0.0):
        return mpf(self.inputs.get(name, default))

    def places(self, theta):
        """The centres of mass of crank, rod, slider as Y + i X in the shaft's frame, and the rod's angle."""
        turned = mp.expj(self.bank)
        angle = theta - self.phase - self.bank
        AB, BC, ec = (self.number(name) for name in ("AB", "BC", "ec"))
        out = mp.expj(angle)
        B = AB * out
        rod = mpmath.mpc(mp.sqrt(BC**2 - (ec + B.imag) ** 2), -(ec + B.imag))
        crank, along = (
            self.number("r_crank", self.inputs["AB"] / 2),
            self.number("r_rod", self.inputs["BC"] / 2) / BC,
        )
        return [turned * place for place in (crank * out, B + along * rod, B + rod)], mp.arg(rod) + self.bank

    def force(self, theta):
        """The load, along its axis, as a complex number of the shaft."""
        angle = theta - self.phase - self.bank - 2 * mp.pi * self.turns
        return mpf(0) if self.load is None else self.load(angle) * mp.expj(self.bank)


MASSES = ("m_crank", "m_rod", "m_slider")


def shaft(sliders, theta, omega, alpha, g=0, I_shaft=0):
    """All sums at a state; g = g_Y + i g_X."""
    theta, omega, alpha = mpf(theta), mpf(omega), mpf(alpha)
    names = ("T_in", "M_eff", "kinetic_energy", "potential_energy", "power_in", "M_shaking", "M_inertia")
    result = dict.fromkeys((*names, "F", "I", "C"), mpf(0))
    result["M_eff"] += mpf(I_shaft)
    result["M_inertia"] -= mpf(I_shaft) * alpha
    slope = mpf(0)
    for slider in sliders:
        h = mpf(10) ** (-mp.dps // 5)
        steps = [slider.places(theta + k * h) for k in range(-3, 4)]
        bodies = [
            (slider.number(m), slider.number(i))
            for m, i in zip(MASSES, ("I_crank", "I_rod", ""), strict=True)
        ]
        turning = [[theta + k * h for k in range(-3, 4)], [angle for _, angle in steps], [mpf(0)] * 7]
        for n, (mass, inertia) in enumerate(bodies):
            r, v, a = _rates([places[n] for places, _ in steps], h)
            _, w, b = _rates(turning[n], h)
            force = -mass * (v * alpha + a * omega**2)
            result["M_eff"] += mass * abs(v) ** 2 + inertia * w**2
            slope += 2 * (mass * (v.real * a.real + v.imag * a.imag) + inertia * w * b)
            result["I"] += force
            result["C"] += slider.position * force
            result["M_inertia"] += _moment(r, force) - inertia * (w * alpha + b * omega**2)
            result["potential_energy"] -= mass * _dot(g, r)
            result["T_in"] -= mass * _dot(g, v)
            result["F"] += mass * g
            result["M_shaking"] += mass * _moment(r, g)
            if n == 2:
                load = slider.force(theta)
                result["T_in"] -= _dot(load, v)
                result["F"] += load
                result["M_shaking"] += _moment(r, load)
    result["T_in"] += result["M_eff"] * alpha + slope * omega**2 / 2
    result["kinetic_energy"] = result["M_eff"] * omega**2 / 2
    result["power_in"] = result["T_in"] * omega
    result["M_shaking"] += result["M_inertia"]
    result |= {f"F_shaking_{n}": part for n, part in _axes(result["F"] + result["I"])}
    result |= {f"F_inertia_{n}": part for n, part in _axes(result.pop("I"))}
    result |= {f"C_inertia_{n}": part for n, part in _axes(result.pop("C"))}
    del result["F"]
    return result


def _axes(force):
    force = mpmath.mpc(force)
    return ("X", force.imag), ("Y", force.real)


def _dot(a, b):
    a, b = mpmath.mpc(a), mpmath.mpc(b)
    return a.real * b.real + a.imag * b.imag


def _moment(r, force):
    """y F_X - x F_Y."""
    r, force = mpmath.mpc(r), mpmath.mpc(force)
    return r.real * force.imag - r.imag * force.real


def _rates(values, h):
    """The middle one and its first two derivatives, by differences of seven."""
    a, b, c, d, e, f, g = values
    first = (45 * (e - c) - 9 * (f - b) + (g - a)) / (60 * h)
    second = (2 * (a + g) - 27 * (b + f) + 270 * (c + e) - 490 * d) / (180 * h * h)
    return d, first, second


def torque_with_friction(c, mu, force, theta, omega, alpha):
    """The torque on one crank with friction of the guide in doubles, by the balance of each body."""
    out = np.exp(1j * theta)
    B = c["AB"] * out
    psi = np.arcsin(-(c["ec"] + B.imag) / c["BC"])
    rod = c["BC"] * np.exp(1j * psi)
    w = -B.real * omega / rod.real
    b = (w * w * np.sin(psi) - (B.real * alpha - B.imag * omega**2) / c["BC"]) / np.cos(psi)
    a_B, of_rod = B * (1j * alpha - omega**2), 1j * b - w * w
    along, way = (a_B + rod * of_rod).real, np.sign((1j * omega * B + 1j * w * rod).real)
    centre = c["r_rod"] / c["BC"] * rod
    turned = c["m_rod"] * (a_B + centre * of_rod)
    turns = c["I_rod"] * b + _moment_of(centre, turned)  # about the crank pin
    push = c["m_slider"] * along - force
    for side in (1.0, -1.0):
        N = (turns - rod.imag * push) / (rod.real + rod.imag * mu * side * way)
        if side * N >= 0.0:
            break
    on_slider = push + mu * abs(N) * way - 1j * N
    crank = c["r_crank"] * out
    inertia = c["m_crank"] * crank * (1j * alpha - omega**2)
    return c["I_crank"] * alpha + _moment_of(crank, inertia) + _moment_of(B, turned + on_slider)


def _moment_of(r, force):
    return r.real * force.imag - r.imag * force.real
