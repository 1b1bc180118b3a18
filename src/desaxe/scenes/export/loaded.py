"""Loads in a compiled module: their tables as text, and the calls that look them up.

The kernels of the module take the load as an input of its own; `point`, `evaluate` and `run` look it up at
theta, and add its slope where a derivative is total. A load over Y needs the slider's position and its
derivatives first: the kernels give them without it.
"""

from collections.abc import Mapping, Sequence
from textwrap import wrap

from ...loads.load import Load, OverTheta, OverY, TableOverTheta
from ...loads.resolve import Plan
from ...loads.stroke import OverStroke
from ...loads.table import Table
from ..schema import SceneError
from .axes import arguments_of, taken_from

LOOK_UP = '''def {name}_over_theta(theta):
    """The load {name} [{unit}] and its derivative by theta, at angles [rad]."""
    first, finite = {name}_KNOTS[0], isfinite(theta)
    turned = where(finite, theta, first)
    turned = turned - {period!r} * floor((turned - first) / {period!r})
    turned = where(turned < first, turned + {period!r}, turned)
    turned = where(turned >= first + {period!r}, turned - {period!r}, turned)
    piece = searchsorted({name}_KNOTS, turned, side="right") - 1
    a, b, c, d = {name}_ROWS[:, piece]
    s = turned - {name}_KNOTS[piece]
    value, slope = a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * (3.0 * d))
    return where(finite, value, 0.0), slope
'''


OUTSIDE = '''def {name}(Y):
    """A load [{unit}] and its derivative by Y, at positions [m]; beyond its ends the table is constant."""
    piece = searchsorted({name}_KNOTS, Y, side="right")
    a, b, c, d = {name}_ROWS[:, piece]
    s = Y - {name}_KNOTS[where(piece > 0, piece - 1, 0)]
    value, slope = a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * (3.0 * d))
    return where(isfinite(Y), value, 0.0), slope
'''
OVER_Y = '''def {name}_over_Y(motion, way):
    """The load {name} [{unit}] and its derivative by Y; `way` is negative where the crank turns backwards."""
    Y, ahead, bend = (asarray(motion[key], float64) for key in ("Y", "Y_wrt_theta", "Y_wrt_theta_theta"))
    value, slope = {name}_outward(Y)
    inward, steep = {name}_inward(Y)
    ahead = where(ahead == 0.0, bend, ahead)
    back = where(asarray(way, float64) < 0.0, -ahead, ahead) < 0.0
    return where(back, inward, value), where(back, steep, slope)
'''


def require_tables(where: str, loads: Mapping[str, Load]) -> None:
    """SceneError for a load that cannot be written into a module."""
    for name, load in loads.items():
        if not isinstance(load, (TableOverTheta, OverY)) or isinstance(load, OverStroke):
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: a compiled module holds tables over theta or Y; sample "
                "the function, desaxe.over_theta(angles, f(angles)), or leave the load open as a list of "
                "values, and give it at each angle"
            )


def table_text(name: str, load: Load, unit: str) -> str:
    """The table of a load, and the function that looks it up."""
    if isinstance(load, TableOverTheta):
        about = f"# {name} over theta: {load.kind}, with the period {load.period!r} rad."
        rows = _arrays(name, load.table.knots, load.table.rows[1:])
        return "\n".join([about, *rows, "", "", LOOK_UP.format(name=name, unit=unit, period=load.period)])
    assert isinstance(load, OverY)
    ways: dict[str, Table] = {"outward": load.outward, "inward": load.inward or load.outward}
    lines = [f"# {name} over Y: {load.kind}, for a slider that goes outward and inward."]
    for way, table in ways.items():
        own = f"{name}_{way}"
        lines += [*_arrays(own, table.knots, table.rows), "", "", OUTSIDE.format(name=own, unit=unit), ""]
    return "\n".join([*lines, OVER_Y.format(name=name, unit=unit)])


def _arrays(name: str, knots: Sequence[float], rows: Sequence[Sequence[float]]) -> list[str]:
    lines = [f"{name}_KNOTS = array([", *_numbers(knots), "])"]
    lines.append(f"{name}_ROWS = array([  # cubics in the distance from a knot")
    for column in zip(*rows, strict=True):
        lines += ["    [", *(f"    {row}" for row in _numbers(column)), "    ],"]
    return [*lines, "])"]


def _numbers(values: Sequence[float]) -> list[str]:
    return [f"    {row}" for row in wrap(", ".join(map(repr, values)) + ",", 90)]


def calls_text(
    plan: Plan,
    inputs: Sequence[str],
    axes: Sequence[str],
    fixed_theta: float | None,
    fixed: Mapping[str, float],
) -> str:
    """`point`, `evaluate` and `run` under the loads; those of the kernels have `_at_load` in their names."""
    own = [name for name in inputs if name not in plan.loads]
    arguments = [*(own if fixed_theta is not None or "theta" in own else ["theta", *own])]
    theta = [] if fixed_theta is None else [f"    theta = {fixed_theta!r}"]
    over_Y = [n for n, load in plan.loads.items() if isinstance(load, OverY)]
    terms = []
    for name, group in plan.terms.items():
        for term in group:
            by = f' * first["Y_wrt_{term.parameter}"]' if term.force in over_Y else ""
            terms.append(
                f'    found["{name}"] = found["{name}"] + found["{term.slope}"] * {term.force}_slope{by}'
            )
    looked_up = [
        f"    {n}, {n}_slope = {n}_over_theta(doubles(theta=theta)[0])"
        for n, load in plan.loads.items()
        if isinstance(load, OverTheta)
    ]
    numbers = [f"    {n}, {n}_slope = float({n}), float({n}_slope)" for n in plan.loads if n not in over_Y]
    position = [f"    {n}, {n}_slope = {n}_over_Y(first, {_way(inputs, fixed)})" for n in over_Y]
    plain = [f"    {n}, {n}_slope = float({n}), float({n}_slope)" for n in over_Y]
    none = [f"    {n} = 0.0  # the motion first, which no load changes" for n in over_Y]
    shown = [f"    return {{name: found[name] for name in {tuple(plan.shown)!r}}}"]
    point = [
        f"def point({', '.join(arguments)}):",
        '    """One point: numbers in, a tuple out, in the order of OUTPUTS."""',
    ]
    point += [*theta, *looked_up, *numbers]
    if over_Y:
        point += [*none, f"    first = dict(zip(PARTS, point_at_load({', '.join(inputs)}), strict=True))"]
        point += [*position, *plain]
    point += [f"    found = dict(zip(PARTS, point_at_load({', '.join(inputs)}), strict=True))", *terms]
    point += [f"    return tuple(found[name] for name in {tuple(plan.shown)!r})"]
    head = ", ".join([*arguments, "threads=None"])
    evaluate = [f"def evaluate({head}):", f'    """{", ".join(plan.shown)} at points of your own: a dict."""']
    evaluate += [*theta, *looked_up]
    if over_Y:
        first = f"    first = evaluate_at_load({', '.join([*inputs, 'threads=threads'])})"
        evaluate += [*none, first, *position]
    evaluate += [f"    found = evaluate_at_load({', '.join([*inputs, 'threads=threads'])})", *terms, *shown]
    run = [
        f"def run({arguments_of(axes)}):" if axes else "def run(threads=None):",
        '    """The values over the scene\'s axes, one dimension an axis."""',
    ]
    if axes:
        run += [
            taken_from(axes),
            "    shape = tuple(axis.size for axis in axes.values())",
            "    places = range(len(shape))",
            "    along = {",
            "        name: axis.reshape([-1 if k == place else 1 for k in places])",
            "        for place, (name, axis) in enumerate(axes.items())",
            "    }",
            "    found = evaluate(**along, threads=threads)",
            "    return {name: array(broadcast_to(value, shape)) for name, value in found.items()}",
        ]
    else:
        run.append("    return evaluate()")
    return "\n\n\n".join("\n".join(lines) for lines in (point, evaluate, run))


def _way(inputs: Sequence[str], fixed: Mapping[str, float]) -> str:
    """The sign of the crank's speed as a text; of a given state that rests, of its acceleration."""

    def text(name: str) -> str:
        return name if name in inputs else repr(float(fixed[name])) if name in fixed else "1.0"

    if "omega" not in (*inputs, *fixed):
        return text("omega0")
    alpha = text("alpha") if "alpha" in (*inputs, *fixed) else "0.0"
    return f"where(asarray({text('omega')}) == 0.0, {alpha}, {text('omega')})"


def renames() -> dict[str, str]:
    """New names of the kernels' functions that those under loads call."""
    return {"point": "point_at_load", "evaluate": "evaluate_at_load", "OUTPUTS": "PARTS"}
