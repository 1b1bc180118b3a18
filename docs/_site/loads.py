"""Which call takes which kind of load: each is called once with each, when the site is built."""

import io
import tempfile
from base64 import b64encode
from pathlib import Path

import matplotlib
import numpy as np

import desaxe as dx

THETA = np.linspace(0.0, 6.0, 5)
DESIGN = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 30.0, "m_slider": 2.0}
KINDS = {
    "number": -50.0,
    "`over_theta`": dx.over_theta([0.0, 2.0, 4.0], [0.0, -50.0, 0.0]),
    "`over_Y`": dx.over_Y([0.15, 0.2, 0.25], [0.0, -50.0, -50.0], [0.0, 0.0, 0.0]),
    "`over_stroke`": dx.over_stroke([0.0, 0.01, 0.02], [-50.0, -50.0, 0.0], dead_centre="outer"),
    "`spring`, `damper`, `over_V`, sums": dx.spring(400.0, free=0.2)
    + dx.damper(20.0)
    + dx.over_V([-1, 1], [9, -9]),
    "function of theta": lambda theta: 2.0 * np.sin(theta),
    "function of Y, V_C": lambda Y, V_C: -400.0 * (Y - 0.2) - 20.0 * V_C,
}
MOTOR = dx.kloss(20.0, 0.2, 40.0)
ROUGH = {**DESIGN, "ec": dx.plus_minus(0.01, 1e-4)}
FREE = {name: value for name, value in DESIGN.items() if name != "ec"}
MOVED = {name: value for name, value in DESIGN.items() if name != "omega0"}
SUFFIXES = {"numba": ".py", "jax": ".py"}  # the others write folders or choose their names


def _measured():
    return {"theta": THETA, "T_in": dx.evaluate("T_in", theta=THETA, F_Y=-50.0, **DESIGN)}


# Call -> how it is called with a load, in a folder.
CALLS = {
    "evaluate": lambda load, _: dx.evaluate("T_in", theta=THETA, F_Y=load, **DESIGN),
    "evaluate(quality=True)": lambda load, _: dx.evaluate(
        "T_in", theta=1.0, quality=True, F_Y=load, **DESIGN
    ),
    "function": lambda load, _: dx.function("T_in", F_Y=load, **DESIGN),
    "grid": lambda load, _: dx.grid("T_in", theta=THETA, F_Y=load, **DESIGN),
    "grid(reduce=)": lambda load, _: dx.grid(
        "T_in", theta=THETA, reduce={"theta": "absmax"}, F_Y=load, **DESIGN
    ),
    "grid(chunks=)": lambda load, _: dx.grid("T_in", theta=THETA, chunks={"theta": 3}, F_Y=load, **DESIGN),
    "sweep": lambda load, room: dx.sweep("T_in", store=str(room / "s.zarr"), theta=THETA, F_Y=load, **DESIGN),
    "peak": lambda load, _: dx.peak("T_in", F_Y=load, **DESIGN),
    "design_map": lambda load, _: dx.design_map([("absmax", "T_in")], F_Y=load, **DESIGN),
    "harmonics": lambda load, _: dx.harmonics("T_in", orders=2, F_Y=load, **DESIGN),
    "crossings": lambda load, _: dx.crossings("T_in", F_Y=load, **DESIGN),
    "solve": lambda load, _: dx.solve(
        over={"AB": (0.03, 0.08)}, where={("absmax", "T_in"): 4.0}, F_Y=load, **_without("AB")
    ),
    "drive": lambda load, _: dx.drive(F_Y=load, **DESIGN),
    "steady": lambda load, _: dx.steady(torque=MOTOR, I_crank=1.0, F_Y=load, **DESIGN),
    "simulate": lambda load, _: dx.simulate(torque=1.0, t_end=0.01, F_Y=load, **MOVED),
    "enclose": lambda load, _: dx.enclose("T_in", theta=1.0, F_Y=load, **DESIGN),
    "tolerance": lambda load, _: dx.tolerance("T_in", theta=1.0, samples=9, F_Y=load, **ROUGH),
    "optimize": lambda load, _: dx.optimize(
        minimize=("absmax", "T_in"), over={"ec": (0.0, 0.02)}, starts=1, F_Y=load, **FREE
    ),
    "counterweight": lambda load, _: dx.counterweight(F_Y=load, **DESIGN),
    "fit": lambda load, _: dx.fit(_measured(), over={"m_slider": 1.0}, F_Y=load, **_without("m_slider")),
    **{
        call: lambda load, _, call=call: getattr(dx, call)(F_Y=load, **DESIGN)
        for call in ("events", "feasibility")
    },
    "inverse": lambda load, _: dx.inverse(Y=0.2, F_Y=load, **DESIGN),
    "synthesize": lambda load, _: dx.synthesize(stroke=0.1, time_ratio=1.05, BC=0.2, F_Y=load),
    "explore": lambda load, room: dx.explore(path=room / "page.html", F_Y=load, **DESIGN),
    **{
        f"compile(to={to!r})": lambda load, room, to=to: _machine(load).compile(
            room / f"press_{to}{SUFFIXES.get(to, '')}", ["T_in"], theta=THETA, to=to
        )
        for to in ("numba", "c", "octave", "jax", "javascript")
    },
}


def _without(name):
    return {key: value for key, value in DESIGN.items() if key != name}


def _machine(load):
    return dx.Machine(**DESIGN, F_Y=load)


def takes(call, load):
    """True if a call takes a load; a refusal is a TypeError or ValueError."""
    with tempfile.TemporaryDirectory() as room:
        try:
            CALLS[call](load, Path(room))
        except (TypeError, ValueError):
            return False
    return True


def loads():
    """The table of calls and kinds of loads."""
    rows = []
    for call in CALLS:
        each = ["yes" if takes(call, load) else "" for load in KINDS.values()]
        rows.append(f"| `{call}` | {' | '.join(each)} |")
    return "\n".join([f"| call | {' | '.join(KINDS)} |", "|---|" + "---|" * len(KINDS), *rows])


PICTURED = {
    "over_theta": (KINDS["`over_theta`"], None),
    "over_Y": (dx.over_Y([0.03, 0.05, 0.1], [-900.0, -200.0, -50.0], [-900.0, -400.0, -150.0]), None),
    "over_stroke": (
        dx.over_stroke([0.0, 8e-3, 8e-3], [-8e4, -8e4, 0.0], [0.0] * 3, dead_centre="outer"),
        None,
    ),
    "spring": (dx.spring(4e3, free=0.12), (0.08, 0.16)),
    "damper": (dx.damper(linear=50.0, quadratic=40.0), (-3.0, 3.0)),
    "over_V": (dx.over_V([-2.0, 0.0, 2.0], [900.0, 0.0, -400.0]), None),
}


def load_picture(name):
    """A picture of a load of a kind."""
    load, over = PICTURED[name]
    file = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": name}):
        dx.plot.load(load, over=over).figure.savefig(file, format="svg", metadata={"Date": None})
    data = b64encode(file.getvalue()).decode()
    words = repr(load).strip("<>")
    return f'<img alt="{words}" src="data:image/svg+xml;base64,{data}">'


WRITERS = (loads,)
