"""The C source of an FMU: the Programs as functions of one array, tables, and the files beside this one."""

from collections.abc import Iterable, Mapping, Sequence

from ....compiler.languages.c.functions import called_through
from ....compiler.languages.c.helpers import HELPERS, PRAGMAS
from ....compiler.languages.c.language import quoted, sine_and_cosine
from ....compiler.languages.c.steps import RUNGE_KUTTA
from ....compiler.languages.shared import arrays_of, comment, with_helpers
from ....compiler.program import Program
from ....loads.load import Load, OverY, TableOverTheta
from ....mechanism.constants import constants
from ....mechanism.inputs import INPUTS
from ....mechanism.status import PointStatus
from ....support.template import file_text
from .programs import HELD, THROUGH, TORQUE, Programs
from .variables import NOMINAL, Variables

EDGE = 1e-9  # rad: so near to a limit angle a motion ends
STANDS = 1e-12  # rad/s: so slow a crank with friction stands
LETS_GO = 1e-9  # rad/s^2: so far beyond what friction can hold, a crank at rest is an event
STRUCTS = """\
typedef void (*Callback)(void);
typedef struct {
  int place;
  double least;
  const char *name, *limit;
} Check;
/* A table added to a force; period of an angle, or 0. Knots at which value or slope jumps are kinks. */
typedef struct {
  int force, held; /* where the force, and what is held of the table, stand in v */
  int column, origin; /* where its argument, and the dead centre as its origin, stand among the columns */
  int two_ways, n, n_kinks;
  double period;
  const char *centre; /* NULL where no dead centre is needed */
  const double *knots, *rows;
  const int *kinks;
} Load;"""


def source_text(head: Sequence[str], table: Variables, made: Programs, token: str) -> str:
    """The whole source."""
    functions = _functions(table, made)
    model = file_text(__package__, "model.c").replace("/*STEP*/\n", RUNGE_KUTTA)
    parts = [
        comment(head),
        *(f"#include <{name}.h>" for name in ("math", "stdint", "stdio", "stdlib", "string")),
        '#include "fmi2Functions.h"\n',
        PRAGMAS,
        *with_helpers("\n".join([sine_and_cosine(constants()), *functions, model]), HELPERS),
        sine_and_cosine(constants()),
        *functions,
        "\n".join([*_sizes(table, made, token), STRUCTS, *_tables(table, made), *_loads(table, made)]) + "\n",
        model,
        file_text(__package__, "fmi2.c"),
    ]
    return "\n".join(parts)


def _parts(made: Programs) -> dict[str, Load]:
    """The tables of all forces by name."""
    return {name: table for parts in made.tables.values() for name, table in parts.items()}


def _places(table: Variables, made: Programs) -> dict[str, int]:
    """The indices in v: of variables, of two limit angles, of what tables are held by."""
    more = ("FIRST_ANGLE", "LAST_ANGLE", *(f"{name}_{held}" for name in _parts(made) for held in HELD))
    return table.place | {name: len(table.rows) + k for k, name in enumerate(more)}


def _functions(table: Variables, made: Programs) -> list[str]:
    """Each Program, and a function that calls it with its places in the array."""
    place, moves = _places(table, made), made.motion is not None
    motion = made.motion or Program((), (), (), {})
    return [
        *_function("outputs", made.outputs, place, len(made.outputs.outputs), made.status, "alpha"),
        *_function("slopes", made.slopes, place, len(made.slopes.outputs), None, "alpha"),
        *_function("limits", made.limits, place, 4, 4),
        *_function("columns", made.columns, place, len(made.columns.outputs), None),
        *_function("motion", motion, place, int(moves), 1 if moves else None, "way"),
    ]


def _function(
    name: str, program: Program, place: Mapping[str, int], count: int, status: int | None, extra: str = ""
) -> list[str]:
    cells = {n: f"v[{k}]" for n, k in place.items()} | ({extra: extra} if extra else {})
    more = f"double {extra}, " if extra else ""
    head = f"static int eval_{name}(const double v[], {more}double out[])"
    return called_through(name, program, head, cells, count, status)


def _sizes(table: Variables, made: Programs, token: str) -> list[str]:
    """Sizes and places, as C."""
    place, moves = _places(table, made), bool(table.states)
    sizes = {
        "N_VALUES": len(table.rows), "N_ALL": len(place), "N_PARAMETERS": len(table.parameters),
        "N_INPUTS": len(table.inputs), "N_OUTPUTS": len(table.outputs), "N_EVENTS": table.indicators,
        "N_SLOPES": len(made.entries), "FIRST_PARAMETER": place[table.parameters[0]],
        "FIRST_INPUT": place[table.inputs[0]], "HAS_STATES": int(moves), "THETA": place["theta"],
        "OMEGA": place["omega"], "THETA0": place["theta0"], "OMEGA_START": place.get("omega_start", 0),
        "TORQUE": place.get("torque", 0), "DER_THETA": place.get("der(theta)", 0),
        "DER_OMEGA": place.get("der(omega)", 0), "EC": place["ec"], "LENGTH_AB": place["AB"],
        "LENGTH_BC": place["BC"], "MU": place["mu"], "ALPHA": -1, "AT_REST": 2 * moves,
        "FIRST_ANGLE": place["FIRST_ANGLE"], "LAST_ANGLE": place["LAST_ANGLE"],
        "TORQUE_ROW": _rows(table)[TORQUE], "N_CHECKS": len(_checks(table)), "N_LOADS": len(_parts(made)),
        "TURNING_LOADS": sum(map(_two_ways, _parts(made).values())), "N_COLUMNS": len(made.columns.outputs),
        "N_THROUGH": len(THROUGH), "RISES": 0,
        "EDGE": EDGE, "NOMINAL": NOMINAL, "STANDS": STANDS, "LETS_GO": LETS_GO, "TOKEN": quoted(token),
    }  # fmt: skip
    return [f"#define {name} {size}" for name, size in sizes.items()]


def _rows(table: Variables) -> dict[str, int]:
    return {name: number for number, name in enumerate(dict.fromkeys((*table.outputs, TORQUE)))}


def _checks(table: Variables) -> list[str]:
    result = []
    for name in (*table.parameters, *table.inputs):
        row = INPUTS.get(name) if name in table.parameters else None
        least, limit = (None, "a finite number") if row is None else (row.least, row.limit)
        bound = -1e308 if least is None else least
        result.append(f"{{{table.place[name]}, {bound!r}, {quoted(name)}, {quoted(limit)}}}")
    return result


def _tables(table: Variables, made: Programs) -> list[str]:
    """Starts, places of outputs and slopes, limits of inputs, as C."""
    rows, place = _rows(table), table.place
    slopes = [f"{{{rows[row]}, {place.get(by, -1)}}}" for row, by in made.entries]
    return [
        array_text("double START[N_VALUES]", [repr(row.start or 0.0) for row in table.rows]),
        array_text("int OUTPUTS[N_OUTPUTS + 1]", [*(str(place[n]) for n in table.outputs), "0"]),
        array_text("int SLOPES[N_SLOPES + 1][2]", [*slopes, "{0, 0}"]),
        array_text("Check CHECKS[N_CHECKS]", _checks(table)),
        array_text("char *const REASONS[]", [quoted(one.words) for one in PointStatus]),
    ]


def _two_ways(load: Load) -> bool:
    return isinstance(load, OverY) and load.inward is not None


def _loads(table: Variables, made: Programs) -> list[str]:
    """The tables of loads and their kinks, as C."""
    rows, place = [], _places(table, made)
    arrays = arrays_of({name: load.arrays() for name, load in _parts(made).items()})
    lines = [array_text(f"double {name}[]", map(repr, column)) for name, column in arrays.items()]
    start = {column: 1 + k * (1 + len(THROUGH)) for k, column in enumerate(made.used)}
    for force, parts in made.tables.items():
        for name, load in parts.items():
            knots, kinks = load.arrays()[0], _kinks(load)
            lines.append(array_text(f"int {name}_kinks[]", [*map(str, map(knots.index, kinks)), "0"]))
            sizes = (
                place[force], place[f"{name}_shift"], start[load.needs[0]], start.get(load.centre, 0),
                int(_two_ways(load)), len(knots), len(kinks), getattr(load, "period", 0.0),
            )  # fmt: skip
            centre = quoted(load.centre.removeprefix("Y_")) if load.centre else "NULL"
            rows.append(f"{{{', '.join(map(repr, sizes))}, {centre}, {name}_x, {name}_c, {name}_kinks}}")
    rows.append("{0, 0, 0, 0, 0, 0, 0, 0.0, NULL, NULL, NULL, NULL}")
    return [*lines, array_text("Load LOADS[N_LOADS + 1]", rows)]


def _kinks(load: Load) -> list[float]:
    """The knots at which a load or its slope jumps; that of a dead centre is no event beside its own.

    Over the speed, where only slopes jump, there is none: steps become short there.
    """
    if isinstance(load, OverY):
        return [x for x in load.positions(smooth=False) if not load.centre or x > 0.0]
    return sorted(load.tables[0].kinks) if isinstance(load, TableOverTheta) else []


def array_text(head: str, items: Iterable[str]) -> str:
    """A constant array of C."""
    return f"static const {head} = {{\n" + "".join(f"  {item},\n" for item in items) + "};"
