"""The status codes: one enumeration a call, with the text of each code.

A code means what its own call says: 2 is a change point of an `evaluate`, a limit angle of a `simulate`.
Codes are numbers (int8 in arrays) and compare with these members: found["status"] == PeakStatus.AT_LIMIT.
"""

from enum import IntEnum


class Status(IntEnum):
    """A status code with its text."""

    words: str

    def __new__(cls, code: int, words: str = "") -> "Status":
        """A member that is its integer code; `words` is its text."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.words = words
        return member


class PointStatus(Status):
    """The status of a point: `evaluate`, `grid`.

    Decided by `derive/stable.py` (0 to 3), `compiler/passes/guard.py` (4), `derive/dynamics.py` (5, 6: in the
    place of the first by `runtime/request.py`, where a force is requested); next to a limit angle in
    double-double by `runtime/point.py` and `runtime/executor.py`.
    """

    OK = 0, "ok"
    CANNOT_BE_ASSEMBLED = 1, "cannot be assembled here"
    CHANGE_POINT = 2, "change point"
    STALLED = 3, "stalled"
    BAD_INPUT = 4, "bad input"
    NO_FORCE_BALANCE = 5, "friction jams: no balance of forces"
    TWO_FORCE_BALANCES = 6, "friction: two balances of forces"


class PeakStatus(Status):
    """The status of a design over a range of crank angles: `peak`, `[[peak]]` of a scene.

    Decided by `peaks/special.py`.
    """

    OK = 0, "ok"
    CANNOT_BE_ASSEMBLED = 1, "cannot be assembled at any of these angles"
    AT_LIMIT = 2, "reached at a limit angle or change point, or where friction turns round: no gradient there"
    STALLED = 3, "stalled at all of these angles"
    BAD_INPUT = 4, "bad input"
    NO_FORCE_BALANCE = (
        5,
        "jammed by friction at some angles (no balance of forces); the peak is of the others",
    )
    TWO_FORCE_BALANCES = 6, "with two balances of forces at some angles (friction); the peak is of the others"


class TurnStatus(Status):
    """The status of a design: `feasibility`, `events`, `design_map`.

    Decided by `design/feasibility/`, `design/events/` and `design/design_map.py`.
    """

    TURNS = 0, "the crank turns fully"
    CANNOT_TURN = 1, "the crank does not turn fully"
    CHANGE_POINT = 2, "at a change point: the margin is 0"
    BAD_INPUT = 4, "bad input"


class CrossingStatus(Status):
    """The status of a design: `crossings`.

    Decided by `design/turn/crossings.py`.
    """

    OK = 0, "ok"
    CANNOT_TURN = 1, "the crank does not turn fully"
    CHANGE_POINT = 2, "at a change point: the margin is 0"
    EQUAL = 3, "equal to the value at all angles"
    BAD_INPUT = 4, "bad input"
    NO_VALUE = 5, "no value at some angles: friction jams, or has two balances of forces"


class SolveStatus(Status):
    """The status of a search: `solve`.

    Decided by `design/solve.py`.
    """

    OK = 0, "ok"
    NOT_REACHED = 1, "the value is not reached"
    CANNOT_TURN = 2, "the crank does not turn fully anywhere in the range"
    EQUAL = 3, "the quantity has the value everywhere in the range"


class InverseStatus(Status):
    """The status of a slider position: `inverse`.

    Decided by `design/inverse.py`.
    """

    OK = 0, "two solutions or one"
    OUT_OF_REACH = 1, "the slider cannot be there on this branch"
    DEAD_CENTRE = 2, "dead centre: the crank's rates are not determined by the slider's"
    BAD_INPUT = 4, "bad input"


class EnclosureStatus(Status):
    """The status of a box of inputs: `enclose`.

    Decided by `_status` in `enclosure/enclose.py`.
    """

    DEFINED = 0, "defined in all of the box"
    NOWHERE = 1, "defined nowhere in the box"
    PARTLY = 2, "not defined in some of the box, or undecided: the range is of the part where it is"


class ToleranceStatus(Status):
    """The status of inputs with tolerances: `tolerance`.

    Decided by `design/tolerance/tolerance.py`.
    """

    OK = 0, "ok"
    NO_VALUE = 1, "no value at the means"
    SOME_WITHOUT = 2, "some samples have no value"
    KINK = 3, "a kink at the means: derivatives say little"
    JUMP = 4, "the value jumps within the tolerances: derivatives say nothing, trust the samples"
    NO_DERIVATIVE = 5, "no derivative at the means or next to them"


class OptimizeStatus(Status):
    """The status of a search: `optimize`.

    Decided by `design/optimisation/optimum.py`, of several objectives by `pareto.py`.
    """

    OPTIMUM = 0, "an optimum"
    NO_DESIGN = 1, "no design keeps the limits"
    UNBOUNDED = 2, "the objective grows without bound towards the limit of turning"
    AT_LIMIT = 3, "the best is at the limit of turning, nearly reached by the design returned"
    UNSETTLED = 4, "the search did not settle"
    NO_VALUE = 5, "the objective has no finite value at any design that was looked at"


class SynthesisStatus(Status):
    """The status of a synthesis: `synthesize`.

    Decided by `design/synthesis/synthesize.py`.
    """

    FOUND = 0, "one design or more"
    NONE = 1, "no design"
    OPEN = 2, "the further requirement leaves the design undetermined"


class DriveStatus(Status):
    """The status of a drive over a turn: `drive`.

    Decided by `_status` in `design/drive/drive.py` and, where a turn has no value, by `design/turn/turn.py`.
    """

    OK = 0, "ok"
    CANNOT_TURN = 1, "the crank cannot turn fully"
    CHANGE_POINT = 2, "at a change point"
    STALLED = 3, "the crank stalls within the turn"
    NO_TORQUE = 4, "no finite torque"
    NO_FORCE_BALANCE = 5, "friction jams: no forces balance somewhere on the turn"
    TWO_FORCE_BALANCES = 6, "friction: two sets of forces balance somewhere on the turn"


class SteadyStatus(Status):
    """The status of a steady state: `steady`.

    Decided by `design/steady/result.py`, of an array by `design/steady/steady.py`.
    """

    OK = 0, "ok"
    NONE = 1, "no stable steady state; the message says why"
    BAD_INPUT = 4, "bad input"


class FitStatus(Status):
    """The status of a fit: `fit`.

    Decided by `design/fit/fit.py`.
    """

    CONVERGED = 0, "converged"
    STOPPED = 1, "not converged: other starts or ranges in over= may help"
    OPEN = 2, "the data leave a combination of the unknowns open"


class SimulationStatus(Status):
    """The status of a motion at its end: `simulate`.

    Decided by `simulation/march.py`; of arrays by `simulation/rows.py`.
    """

    DONE = 0, "reached its end"
    REST = 1, "at rest: the torque cannot move the crank"
    LIMIT = 2, "reached a limit angle"
    JAMS = 3, "the friction jams"
    FAILED = 4, "the integration failed"
    NO_INERTIA = 5, "the effective inertia vanishes at a dead centre"
    NO_START = 6, "a bad input, no mechanism at the start, or not the dead centre that a load is over"


TABLES = tuple(Status.__subclasses__())
