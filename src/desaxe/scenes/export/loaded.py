"""A load over theta in a compiled module: its table as text, and the calls that look it up.

The kernels of the module take the load as an input of its own; `point`, `evaluate` and `run` look it up at
theta, and add its slope where a derivative is total.
"""

from collections.abc import Mapping, Sequence
from textwrap import wrap

from ...loads.load import Load, TableOverTheta
from ...loads.resolve import Plan
from ..schema import SceneError
from .axes import arguments_of, taken_from

LOOK_UP = '''def {name}_over_theta(theta):
    """The load {name} [{unit}] and its derivative by theta, at angles [rad]."""
    first = {name}_KNOTS[0]
    turned = theta - {period!r} * floor((theta - first) / {period!r})
    turned = where(turned < first, turned + {period!r}, turned)
    turned = where(turned >= first + {period!r}, turned - {period!r}, turned)
    piece = searchsorted({name}_KNOTS, turned, side="right") - 1
    a, b, c, d = {name}_ROWS[:, piece]
    s = turned - {name}_KNOTS[piece]
    value, slope = a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * (3.0 * d))
    return where(isfinite(theta), value, 0.0), slope
'''


def require_tables(where: str, loads: Mapping[str, Load]) -> None:
    """SceneError for a load that cannot be written into a module."""
    for name, load in loads.items():
        if not isinstance(load, TableOverTheta):
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: a compiled module holds tables over theta; leave the "
                "load open as a list of values, and give it at each angle"
            )


def table_text(name: str, load: TableOverTheta, unit: str) -> str:
    """The table of a load, and the function that looks it up."""
    table = load.table
    lines = [
        f"# {name} over theta: {load.kind}, with the period {load.period!r} rad.",
        f"{name}_KNOTS = array([",
    ]
    lines += _numbers(table.knots)
    lines += ["])", f"{name}_ROWS = array([  # cubics in the distance from a knot"]
    for column in zip(*table.rows[1:], strict=True):
        lines += ["    [", *(f"    {row}" for row in _numbers(column)), "    ],"]
    lines += ["])", "", "", LOOK_UP.format(name=name, unit=unit, period=load.period)]
    return "\n".join(lines)


def _numbers(values: Sequence[float]) -> list[str]:
    return [f"    {row}" for row in wrap(", ".join(map(repr, values)) + ",", 90)]


def calls_text(plan: Plan, inputs: Sequence[str], axes: Sequence[str], fixed_theta: float | None) -> str:
    """`point`, `evaluate` and `run` under the loads; those of the kernels have `_at_load` in their names."""
    own = [name for name in inputs if name not in plan.loads]
    arguments = [*(own if fixed_theta is not None or "theta" in own else ["theta", *own])]
    theta = [] if fixed_theta is None else [f"    theta = {fixed_theta!r}"]
    terms = [
        f'    found["{name}"] = found["{name}"] + found["{term.slope}"] * {term.force}_slope'
        for name, group in plan.terms.items()
        for term in group
    ]
    looked_up = [f"    {n}, {n}_slope = {n}_over_theta(asarray(theta, float64))" for n in plan.loads]
    numbers = [f"    {n}, {n}_slope = float({n}), float({n}_slope)" for n in plan.loads]
    shown = [f"    return {{name: found[name] for name in {tuple(plan.shown)!r}}}"]
    point = [
        f"def point({', '.join(arguments)}):",
        '    """One point: numbers in, a tuple out, in the order of OUTPUTS."""',
    ]
    point += [*theta, *looked_up, *numbers]
    point += [f"    found = dict(zip(PARTS, point_at_load({', '.join(inputs)}), strict=True))", *terms]
    point += [f"    return tuple(found[name] for name in {tuple(plan.shown)!r})"]
    head = ", ".join([*arguments, "threads=None"])
    evaluate = [f"def evaluate({head}):", f'    """{", ".join(plan.shown)} at points of your own: a dict."""']
    evaluate += [*theta, *looked_up]
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


def renames() -> dict[str, str]:
    """New names of the kernels' functions that those under loads call."""
    return {"point": "point_at_load", "evaluate": "evaluate_at_load", "OUTPUTS": "PARTS"}
