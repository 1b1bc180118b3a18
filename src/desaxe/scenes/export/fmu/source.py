"""The C source of an FMU: the Programs as functions of one array, tables, and the files beside this one."""

from collections.abc import Mapping, Sequence

from ....compiler.languages.c.functions import static_function
from ....compiler.languages.c.helpers import HELPERS, PRAGMAS
from ....compiler.languages.c.language import comment, quoted, sine_and_cosine
from ....compiler.languages.lifted import lifted
from ....compiler.languages.shared import with_helpers
from ....compiler.program import Program
from ....mechanism.constants import constants
from ....mechanism.inputs import INPUTS
from ....mechanism.status import PointStatus
from ....simulation.loops.tableau import E3, E5, STAGES, A
from ....support.template import file_text
from .loads import array_text, loads_text
from .programs import TORQUE, Programs
from .variables import NOMINAL, Variables

EDGE = 1e-9  # rad: so near to a limit angle a motion ends
STANDS = 1e-12  # rad/s: so slow a crank with friction stands


def source_text(head: Sequence[str], table: Variables, made: Programs, fmi: int, token: str) -> str:
    """The whole source."""
    functions = _functions(table, made)
    parts = [
        comment(head),
        "#include <math.h>\n#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>",
        f'#include "fmi{fmi}Functions.h"\n',
        PRAGMAS,
        *with_helpers("\n".join([sine_and_cosine(constants()), *functions]), HELPERS),
        sine_and_cosine(constants()),
        *functions,
        "\n".join(_tables(table, made, fmi, token)) + "\n",
        loads_text(made.loads, table.place),
        *(file_text(__package__, name) for name in ("model.c", "interface.c", f"fmi{fmi}.c")),
    ]
    return "\n".join(parts)


def _functions(table: Variables, made: Programs) -> list[str]:
    """Each Program, and a function that calls it with its places in the array."""
    count = len(made.outputs.outputs)
    found = [
        *_function("outputs", made.outputs, table.place, count, made.status, "double alpha, "),
        *_function("slopes", made.slopes, table.place, len(made.slopes.outputs), None, "double alpha, "),
        *_function("limits", made.limits, table.place, 4, 4, ""),
    ]
    if made.loads:
        found += _function("position", made.position, table.place, len(made.position.outputs), None, "")
        found += _function("inverse", made.inverse, table.place, 2, None, "double Y, ")
    if made.motion is not None:
        return [*found, *_function("motion", made.motion, table.place, 1, 1, "double way, ")]
    none = "static int eval_motion(const double v[], double way, double out[]) {\n  (void)v, (void)way;\n"
    return [*found, none + "  out[0] = 0.0;\n  return 0;\n}\n"]


def _function(
    name: str, program: Program, place: Mapping[str, int], count: int, status: int | None, more: str
) -> list[str]:
    form = lifted(program)
    extra = more.removesuffix(", ").rpartition(" ")[2]
    words = {part: f"turn[{k}]" for pair in form.turns.values() for k, part in enumerate(pair)}
    words |= {extra: extra} if extra else {}
    given = [words.get(n) or f"v[{place[n]}]" for n in form.program.inputs]
    body = [f"double turn[2];\n  sin_cos(v[{place['theta']}], turn);"] if form.turns else []
    body += [f"(void){extra};"] if extra and extra not in given else []
    body += ["(void)v;"] if not form.turns and not any(g.startswith("v[") for g in given) else []
    body += ["(void)out;"] if not count else []
    call = f"{name}({', '.join([*given, *(['out'] if count else [])])});"
    body += [f"return {call}"] if status is not None else [call, "return 0;"]
    lines = "\n  ".join(body)
    return [
        static_function(name, form.program, form.program.inputs, count, status),
        f"static int eval_{name}(const double v[], {more}double out[]) {{\n  {lines}\n}}\n",
    ]


def _tables(table: Variables, made: Programs, fmi: int, token: str) -> list[str]:
    """Sizes, places and starts, as C."""
    place, moves = table.place, bool(table.states)
    sizes = {
        "N_VALUES": len(table.rows), "N_PARAMETERS": len(table.parameters), "N_INPUTS": len(table.inputs),
        "N_OUTPUTS": len(table.outputs), "N_EVENTS": len(table.indicators), "N_SLOPES": len(made.entries),
        "FIRST_PARAMETER": place[table.parameters[0]], "FIRST_INPUT": place[table.inputs[0]],
        "INDICATORS": place[table.indicators[0]], "HAS_STATES": int(moves), "THETA": place["theta"],
        "OMEGA": place["omega"], "THETA0": place["theta0"], "OMEGA_START": place.get("omega_start", 0),
        "TORQUE": place.get("torque", 0), "DER_THETA": place.get("der(theta)", 0),
        "DER_OMEGA": place.get("der(omega)", 0), "EC": place["ec"], "LENGTH_AB": place["AB"],
        "LENGTH_BC": place["BC"], "MU": place["mu"], "ALPHA": -1, "AT_REST": 2 * moves,
    }  # fmt: skip
    rows = {name: number for number, name in enumerate(dict.fromkeys((*table.outputs, TORQUE)))}
    sizes["TORQUE_ROW"] = rows[TORQUE]
    checks = [(place[n], INPUTS[n].least, n, INPUTS[n].limit) for n in table.parameters if n in INPUTS]
    checks += [(place[n], None, n, "a finite number") for n in ("theta0", "omega_start") if n in place]
    checks += [(place[n], None, n, "a finite number") for n in table.inputs]
    slopes = [f"{{{rows[row]}, {place.get(by, -1)}}}" for row, by in made.entries]
    return [
        *(f"#define {name} {value}" for name, value in sizes.items()),
        f"#define N_CHECKS {len(checks)}",
        f"#define EDGE {EDGE!r}",
        f"#define NOMINAL {NOMINAL!r}",
        f"#define STANDS {STANDS!r}",
        f"#define TOKEN {quoted(token)}",
        f"typedef fmi{fmi}ValueReference Place;",
        "typedef void (*Callback)(void);",
        array_text("double START[N_VALUES]", [repr(row.start or 0.0) for row in table.rows]),
        array_text("int OUTPUTS[N_OUTPUTS + 1]", [*(str(place[n]) for n in table.outputs), "0"]),
        array_text("int SLOPES[N_SLOPES + 1][2]", [*slopes, "{0, 0}"]),
        "typedef struct {\n  int place;\n  double least;\n  const char *name, *limit;\n} Check;",
        array_text("Check CHECKS[N_CHECKS]", [_check(*check) for check in checks]),
        array_text("char *const REASONS[]", [quoted(one.words) for one in PointStatus]),
        array_text(
            "double A[12][12]",
            ["{" + ", ".join(map(repr, A[s, :12].tolist())) + "}" for s in range(1, 13)],
        ),
        array_text(f"double E3[{STAGES + 1}]", map(repr, E3.tolist())),
        array_text(f"double E5[{STAGES + 1}]", map(repr, E5.tolist())),
    ]


def _check(place: int, least: float | None, name: str, limit: str) -> str:
    bound = "-(double)INFINITY" if least is None else repr(least)
    return f"{{{place}, {bound}, {quoted(name)}, {quoted(limit)}}}"
