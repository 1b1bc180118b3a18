"""Quantities of a whole design: the lines of `mechanism/closed/dead_centres.py`, proved, with their notes.

The text is written by hand, in forms in which nothing cancels. The proof takes it apart in every sector of
designs that its conditions tell apart: the signs of ec and of the branch, a crank shorter or longer than rod
and offset. There all roots and angles become symbols, r with r^2 = f and a with tan a = y/x, and what is to
be 0 is a polynomial that these relations reduce to 0.
"""

from functools import cache
from itertools import product
from typing import Any

import sympy as sp

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.operations import OPERATIONS
from desaxe.compiler.program import Note, Program
from desaxe.compiler.text import read_function
from desaxe.mechanism.closed.dead_centres import DEAD_CENTRES
from desaxe.mechanism.names import LENGTHS, WHOLE, parts, per, sensitivity
from desaxe.units.dimensions import unit_text
from desaxe.units.parse import coherent_unit

ec, AB, BC = (sp.Symbol(name, real=True) for name in LENGTHS)
# Designs of each sector: of a turning crank, |ec| < AB and |ec| > AB; of a crank longer than the rod.
DESIGNS = ((1, 3, 9), (3, 1, 9), (1, 9, 3))


def whole_design() -> Program:
    """The Program of the dead centres; its derivatives have notes, too."""
    program = prove(read_function(DEAD_CENTRES))
    notes = dict(program.notes)
    for name, length in product(WHOLE, LENGTHS):
        unit = unit_text(per(coherent_unit(notes[name].unit), length))
        notes[sensitivity(name, length)] = Note(unit, f"derivative of {name} with respect to {length}")
    return program._replace(notes=notes)


def prove(program: Program) -> Program:
    """The program; ValueError if a value breaks the geometry or a derivative is not that of its value."""
    for (offset, crank, rod), side, branch, turning in product(DESIGNS, (1, -1), (1, -1), (1, -1)):
        design = {"ec": side * offset, "AB": crank, "BC": rod, "branch": branch, "turning": turning}
        sector = _Sector(program, design)
        wrong = [
            sensitivity(name, p.name)
            for name, p in product(WHOLE, (ec, AB, BC))
            if sector.numbers[name] == sector.numbers[name]
            and not sector.vanishes(sector.slope(sector[name], p) - sector[sensitivity(name, p.name)])
        ]
        wrong += [
            name for name, identity in _geometry(sector, branch, turning) if not sector.vanishes(identity)
        ]
        if wrong:
            raise ValueError(
                f"not proved for ec {side:+}, branch {branch:+}, turning {turning:+}: {', '.join(wrong)}"
            )
    return program


def sensitivity_symbol(p: sp.Symbol) -> sp.Symbol:
    """The derivative of beta by a length."""
    return sp.Symbol(sensitivity("beta", p.name))


def _constant(value: float) -> sp.Expr:
    return sp.nsimplify(value, [sp.pi]) if value == value else sp.nan


def _geometry(sector: "_Sector", branch: int, turning: int) -> list[tuple[str, sp.Expr]]:
    """Expressions that are 0: A, B, C in line at the dead centres, the sines of the rod at its extremes."""
    result = []
    for which, reach in (("outer", AB + BC), ("inner", AB - BC)):  # from A to C, along the crank
        Y, name = sector[f"Y_{which}"], f"theta_{which}"
        sine, cosine = sector.sine_and_cosine(name)
        side = 1 if sector.numbers["rod_over"] < 0 or which == "outer" else -1  # the sign of the reach
        result += [(name, side * sine + ec), (name, side * cosine - Y)]
        result += [(f"Y_{which}", Y**2 + ec**2 - reach**2)]
    if not sector.numbers["can_turn"]:
        return result
    beta = sector["beta"]
    result += [("stroke", branch * (sector["Y_outer"] - sector["Y_inner"]) - sector["stroke"])]
    result += [("beta", sector.turned(beta, p) - sector.slopes[p]) for p in (ec, AB, BC)]
    (so, co), (si, ci) = (sector.sine_and_cosine(f"theta_{which}") for which in ("outer", "inner"))
    y, x = sector.angles[beta]  # beta is pi less the angle from the outer to the inner dead centre
    result += [("beta", branch * (si * co - ci * so) * x + (ci * co + si * so) * y)]
    result += [("advance_angle", sector["advance_angle"] - sp.pi - branch * turning * beta)]
    result += [("return_angle", sector["advance_angle"] + sector["return_angle"] - 2 * sp.pi)]
    side = 1 if sector.numbers["offset"] > 0 else -1
    longer = sp.pi + side * beta
    result += [("time_ratio", sector["time_ratio"] * (2 * sp.pi - longer) - longer)]
    least = side * ec - AB if sector.numbers["reach_in"] else sp.Integer(0)
    for pressure, transmission, lean in (("max", "min", AB + side * ec), ("min", "max", least)):
        name, unit = f"{pressure}_pressure_angle", sector["unit_length"]
        y, x = sector.angles[sector[name]]
        result += [(name, y * unit - lean), (name, (x**2 + y**2) * unit**2 - BC**2)]
        other = f"{transmission}_transmission_angle"
        result += [(other, a - b) for a, b in zip((x, y), sector.angles[sector[other]], strict=True)]
    return result


class _Sector:
    """The lines in symbols; conditions and choices are those of one design of the sector."""

    def __init__(self, program: Program, design: dict[str, int]) -> None:
        self.numbers = run_in_doubles(program, design)
        self.symbols: dict[str, Any] = {"ec": ec, "AB": AB, "BC": BC}
        self.symbols |= {name: sp.Integer(design[name]) for name in ("branch", "turning")}
        self.roots: dict[sp.Symbol, sp.Expr] = {}
        self.angles: dict[sp.Symbol, tuple[sp.Expr, sp.Expr]] = {}
        self.slopes: dict[sp.Symbol, sp.Expr] = {}  # of beta
        for line in program.lines:
            value = self._line(line.op, line.args)
            base, parameters = parts(line.name)
            if base == "beta" and parameters:  # proved as a lemma, and a symbol in what follows
                self.slopes[sp.Symbol(parameters[0], real=True)] = value
                value = sp.Symbol(line.name)
            self.symbols[line.name] = value

    def __getitem__(self, name: str) -> sp.Expr:
        return self.symbols[name]

    def _line(self, op: str, args: tuple[Any, ...]) -> Any:
        values = [self.symbols[a] if isinstance(a, str) else _constant(a) for a in args]
        if op == "select":
            return values[1] if self.numbers[args[0]] else values[2]
        if op in ("lt", "le", "eq", "and", "or", "not"):
            return None
        if op == "abs":
            return -values[0] if self.numbers[args[0]] < 0.0 else values[0]
        if op == "power_of_two":
            return sp.Symbol("unit", positive=True)
        if op == "sqrt":
            return self._new(self.roots, sp.expand(values[0]))
        if op == "atan2":
            return self._new(self.angles, (values[0], values[1]))
        return OPERATIONS[op].exact(sp, *values)

    def _new(self, known: dict[Any, Any], value: Any) -> sp.Symbol:
        """A symbol for a root or an angle."""
        name = sp.Symbol(f"{'root' if known is self.roots else 'angle'}{len(known)}", positive=True)
        known[name] = value
        return name

    def slope(self, expression: sp.Expr, p: sp.Symbol) -> sp.Expr:
        """The derivative with respect to a length."""
        total = expression.diff(p)
        for root, square in self.roots.items():
            total += expression.diff(root) * square.diff(p) / (2 * root)
        for angle in self.angles:
            if expression.has(angle):
                lemma = angle == self["beta"]
                total += expression.diff(angle) * (sensitivity_symbol(p) if lemma else self.turned(angle, p))
        return total

    def turned(self, angle: sp.Symbol, p: sp.Symbol) -> sp.Expr:
        """The derivative of an angle by a length, from those of its tangent."""
        y, x = self.angles[angle]
        return (x * self.slope(y, p) - y * self.slope(x, p)) / (x**2 + y**2)

    def sine_and_cosine(self, name: str) -> tuple[sp.Expr, sp.Expr]:
        """Sine and cosine of pi or 0 plus or minus a known angle, times that angle's hypotenuse."""
        (angle,) = [a for a in self.angles if self[name].has(a)]
        y, x = self.angles[angle]
        base = self[name].subs(angle, 0)
        turn, side = (-1 if base == sp.pi else 1), self[name].diff(angle)
        unit = self["unit_length"]
        return turn * side * y * unit, turn * x * unit

    def vanishes(self, expression: sp.Expr) -> bool:
        """True if an expression is 0 wherever the roots are those of their squares."""
        return _vanishes(expression, tuple(self.roots.items()))


@cache
def _vanishes(expression: sp.Expr, roots: tuple[tuple[sp.Symbol, sp.Expr], ...]) -> bool:
    """The sectors share most of their expressions."""
    rest = sp.numer(sp.together(expression))
    for root, square in roots:
        if rest.has(root):
            rest = sp.rem(sp.expand(rest), root**2 - square, root)
    return bool(sp.expand(rest) == 0)
