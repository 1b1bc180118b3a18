"""`name_step` and `name_alpha`: the motion under a torque, for a controller or hardware in the loop.

A step is one of the classical method of Runge and Kutta, of order 4. With friction, the way in which the
crank turns is held during a step: where it comes to rest, the step is cut, and what is left starts from rest.
"""

from collections.abc import Mapping, Sequence

from ..protocol import OpenTable, Solver
from ..tables import numbers_of
from .functions import lifted, static_function
from .tables import checks, parameters, passed

HEADER = """\
/* The crank's angular acceleration under a torque on it, positive like theta. Of in[], laid out as for
   {name}_point, lengths, masses, loads and friction are read. Returns the status; NaN where it is not 0. */
int {name}_alpha(double torque, double theta, double omega, const double in[], double *alpha{more});

/* One step of h >= 0 seconds, of fixed length and order 4, the torque held: theta and omega become those at
   its end. Returns the status; where it is not 0, both stay as they are. */
int {name}_step(double h, double torque, double *theta, double *omega, const double in[]{more});
"""

AT = """\
/* The acceleration, out[0], while the crank turns one way; returns its status. */
static int motion_at(double torque, double theta, double omega, double way, const double in[],
                     double out[]{known}) {{
{lines}
}}
"""

SMOOTH = """\
int {name}_alpha(double torque, double theta, double omega, const double in[], double *alpha{more}) {{{checks}
  const int status = motion_at(torque, theta, omega, 0.0, in, alpha{these});
  *alpha = status == 0 ? *alpha : (double)NAN;
  return status;
}}
"""

RUBBING = """\
/* The way in which the crank turns or starts from rest, 0 where friction holds it; returns a status. */
static int way_of(double torque, double theta, double omega, const double in[], double *way{known}) {{
  double ahead[1], back[1];
  *way = omega > 0.0 ? 1.0 : -1.0;
  if (!(omega == 0.0)) {{
    return 0;
  }}
  const int status = motion_at(torque, theta, omega, 1.0, in, ahead{these});
  const int other = motion_at(torque, theta, omega, -1.0, in, back{these});
  const int starts = status == 0 && ahead[0] > 0.0, returns = other == 0 && back[0] < 0.0;
  *way = starts ? 1.0 : (returns ? -1.0 : 0.0);
  return starts && returns ? 6 : (status < 5 ? status : 0);
}}

int {name}_alpha(double torque, double theta, double omega, const double in[], double *alpha{more}) {{{checks}
  double way;
  int status = way_of(torque, theta, omega, in, &way{these});
  *alpha = 0.0;
  if (status == 0 && !(way == 0.0)) {{
    status = motion_at(torque, theta, omega, way, in, alpha{these});
  }}
  *alpha = status == 0 ? *alpha : (double)NAN;
  return status;
}}
"""

RUNGE_KUTTA = """\
/* The state after a step, the way of turning held; returns the status. */
static int runge_kutta(double h, double torque, double way, double *theta, double *omega,
                       const double in[]{known}) {{
  const double parts[4] = {{0.0, 0.5, 0.5, 1.0}};
  double speed[4], slope[4];
  for (int k = 0; k < 4; k++) {{
    const double part = h * parts[k];
    const double angle = *theta + (k > 0 ? part * speed[k - 1] : 0.0);
    speed[k] = *omega + (k > 0 ? part * slope[k - 1] : 0.0);
    const int status = motion_at(torque, angle, speed[k], way, in, &slope[k]{these});
    if (status != 0) {{
      return status;
    }}
  }}
  *theta += h / 6.0 * (speed[0] + 2.0 * (speed[1] + speed[2]) + speed[3]);
  *omega += h / 6.0 * (slope[0] + 2.0 * (slope[1] + slope[2]) + slope[3]);
  return fabs(*theta) < (double)INFINITY && fabs(*omega) < (double)INFINITY ? 0 : 4;
}}
"""

SMOOTH_STEP = """\
int {name}_step(double h, double torque, double *theta, double *omega, const double in[]{more}) {{{checks}
  double angle = *theta, speed = *omega;
  const int status = h >= 0.0 ? runge_kutta(h, torque, 0.0, &angle, &speed, in{these}) : 4;
  if (status == 0) {{
    *theta = angle;
    *omega = speed;
  }}
  return status;
}}
"""

RUBBING_STEP = """\
int {name}_step(double h, double torque, double *theta, double *omega, const double in[]{more}) {{{checks}
  double angle = *theta, speed = *omega, left = h;
  for (int turns = 0; turns < 3; turns++) {{
    double way, end = angle, last = speed;
    int status = h >= 0.0 ? way_of(torque, angle, speed, in, &way{these}) : 4;
    if (status == 0 && way == 0.0) {{
      break;
    }}
    status = status == 0 ? runge_kutta(left, torque, way, &end, &last, in{these}) : status;
    double low = 0.0, high = left, at_low = speed, at_high = last, part = left;
    /* Where the speed changes its sign, by the Illinois rule. */
    for (int k = 0; status == 0 && at_high * way < 0.0 && k < 20 && high - low > 1e-15 * h; k++) {{
      part = low + (high - low) * (at_low / (at_low - at_high));
      end = angle;
      last = speed;
      status = runge_kutta(part, torque, way, &end, &last, in{these});
      if (last * way > 0.0) {{
        low = part;
        at_low = last;
        at_high *= 0.5;
      }} else {{
        high = part;
        at_high = last;
        at_low *= 0.5;
      }}
    }}
    if (status != 0) {{
      return status;
    }}
    angle = end;
    left -= part;
    speed = left > 0.0 ? 0.0 : last;
    if (!(left > 0.0)) {{
      break;
    }}
  }}
  *theta = angle;
  *omega = speed;
  return 0;
}}
"""


def step_texts(name: str, motion: Solver, names: Sequence[str], tables: Mapping[str, OpenTable]) -> list[str]:
    """The functions of `HEADER`; `names` are the arguments of a point, in the order of in[]."""
    form = lifted(motion.solve)
    own = [symbol.name for symbol in motion.arguments]  # those of `motion_at`
    turns = {part: f"turn[{k}]" for pair in form.turns.values() for k, part in enumerate(pair)}
    numbers = numbers_of(tables)
    words = {**turns, **{name: name for name in (*own, *numbers)}}
    given = [words.get(n) or f"in[{names.index(n)}]" for n in form.program.inputs]
    lines = [f"double turn[2];\n  sin_cos({angle}, turn);" for angle in form.turns]
    used = {*given, *form.turns} | ({"in"} if any(each.startswith("in[") for each in given) else set())
    lines += [f"(void){n};" for n in (*own, *numbers, "in") if n not in used]
    lines.append(f"return motion({', '.join([*given, 'out', *passed(tables)])});")
    rubs = own[-1] in motion.solve.inputs
    texts = [AT, RUBBING if rubs else SMOOTH, RUNGE_KUTTA, RUBBING_STEP if rubs else SMOOTH_STEP]
    body = "\n".join(f"  {line}" for line in lines)
    told = {
        "name": name,
        "lines": body,
        "more": parameters(tables),
        "checks": "\n  ".join(["", *checks(tables)]),
        "known": "".join(f", double {number}" for number in numbers) + parameters(tables),
        "these": "".join(f", {each}" for each in (*numbers, *passed(tables))),
    }
    made = [text.format(**told) for text in texts]
    return [static_function("motion", form.program, form.program.inputs, 1, 1, tables=tables), *made]
