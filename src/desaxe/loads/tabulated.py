"""`over_theta` and `over_Y`: loads from tables, files and functions."""

from collections.abc import Callable
from typing import Any

from ..mechanism.closed import TURN
from ..mechanism.messages import amount
from ..support.shown import shown
from .columns import Column, column_of
from .function import FunctionOverTheta
from .load import Load
from .made import dead_centre_of, table_over_stroke, table_over_theta, table_over_Y
from .of_columns import MakeTable
from .units import functions_over, load_over

LONGEST_PERIOD = 1e9


class MakeOverTheta(MakeTable):
    """`over_theta(angles, values)`: a load over the crank angle, wherever F_X, F_Y or a torque is given.

        press = dx.over_theta(["0 deg", "90 deg", "180 deg", "270 deg"], [0, -400, -50, 0], kind="linear")
        dx.peak("T_in", F_Y=press, ec=0.01, AB=0.04, BC=0.064)

    angles  ascending crank angles [rad], or texts with units; within one period. The end of the period may
            repeat the first point. A Series alone gives both: its index, its values
    values  the load [SI units of the input that it is given for], or texts with units
    kind    "cubic" (a periodic cubic spline, which may go beyond its points), "linear", or "step" (each value
            holds to the right); "cubic" without
    period  after which it repeats [rad]; two turns for a four-stroke engine

    `machine.over_theta` is the same in the units of a machine: its plain angles, forces and periods, and the
    angle and the force of a function.

    `over_theta(f, derivative=None, nodes=())` makes one of a function of one argument, the angle as it is
    (arrays in, arrays out, or numbers alone: `np.sin`, too). Names that need the slope of a load, such as
    T_in_wrt_theta, need its derivative. nodes: angles at which it has kinks or jumps, in each period.

    `over_theta.read("press.csv", theta="deg", value="N")` reads a table from the first two columns of a file.

    area, bore  of a piston; also in `over_Y`, `over_stroke` and each `read`. Values are then pressures [Pa],
                or texts in bar, MPa, psi; the load is -(p - ambient) area: gas pushes it towards the crank
    ambient     the pressure on its other side; 0 without

    Loads of any kind and numbers add up; `2 * load` is a multiple, `load.shifted("120 deg")` lags by an
    angle.

    Derivatives by theta are total: they include the load's slope; at a kink it is that to the right. Raises
    ValueError or TypeError for a table that is no periodic function.
    """

    name = "over_theta"
    takes = "angles, values, kind='cubic', period=2 pi"
    places, ways, over, si, values = "angles", ("values",), "theta", "rad", ("N", "N*m")

    def __call__(
        self,
        angles: Any,
        values: Any = None,
        kind: Any = "cubic",
        period: Any = TURN,
        *,
        derivative: Callable[[Any], Any] | None = None,
        nodes: Any = (),
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the crank angle; see `help(desaxe.over_theta)`."""
        turn, piston = self._period(period), self.piston(area, bore, ambient)
        if callable(angles):
            if not isinstance(kind, str):
                nodes = kind
            places = column_of("over_theta: nodes", nodes, ("rad",), self.unit("theta")).values
            functions = functions_over(
                "over_theta", "theta", (angles, values, derivative), self.units, piston
            )
            return FunctionOverTheta(*functions, tuple(places), turn.values[0])
        if derivative is not None or len(nodes):
            raise TypeError("over_theta: derivative= and nodes= belong to a function; a table has its own")
        x, y = self.columns(angles, values, piston=piston)
        return table_over_theta(x, y, kind, turn, self.units)

    def read(
        self,
        path: Any,
        theta: str | None = None,
        value: str | None = None,
        kind: str = "cubic",
        period: Any = TURN,
        *,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the crank angle from the first two columns of a file or a frame.

        path           of a text (.csv, .txt, ...), or of a workbook, whose first sheet is read; or a frame of
                       pandas or polars
        theta, value   units of the columns, such as "deg" and "N"; without, those of the heading, such as
                       "theta [deg], F_Y (kN)", else SI units, those of the machine for `machine.over_theta`
        kind, period   as in `over_theta`

        Columns stand between semicolons, tabs, blanks or commas; but between commas, numbers may have decimal
        commas. Lines above the numbers are a heading, lines that begin with # are left out. Raises
        ValueError, which names file, line and column.
        """
        more = {"kind": kind, "period": period, "area": area, "bore": bore, "ambient": ambient}
        load: Load = self.from_file(path, {"theta": theta, "value": value}, **more)
        return load

    def _period(self, period: Any) -> Column:
        if isinstance(period, float) and period == TURN:  # a turn, in any unit
            return Column([TURN])
        result = column_of("over_theta: period", [period], ("rad",), self.unit("theta"))
        if not 0.0 < result.values[0] <= LONGEST_PERIOD:
            most = amount("theta", LONGEST_PERIOD, "g", says_unit=True)
            limit = ": expected an angle above 0 and at most " + most
            raise ValueError(f"over_theta: period = {shown(period)}" + limit)
        return result


class MakeOverY(MakeTable):
    """`over_Y(positions, outward, inward=None)`: a load over the slider's position, for F_X and F_Y.

    For what is fixed in the frame, as a cylinder: the load follows the slider, so that sensitivities by
    theta and by every length include dF/dY dY/dp. A die that is set to the end of the stroke, whatever the
    lengths, is `over_stroke`.

        gas = dx.over_Y(["30 mm", "50 mm", "100 mm"], outward=[-900, -200, -50], inward=[-900, -400, -150])

    positions  of the slider along Y [m], ascending or descending, or texts with units
    outward    the load where Y increases with time, at each position
    inward     where it decreases; as outward without
    kind       "linear", "step" (a value holds towards larger Y), or "cubic" (a spline, extra `simulate`);
               "linear" without

    Beyond the positions the values at the ends hold. Where the crank stands still it counts as turning
    forwards, or the way that a given alpha starts it. `over_Y.read("indicator.csv", Y="mm", value="N")`
    reads the columns position, outward and, where there is one, inward. `over_Y(f, derivative=None)` makes a
    load of a function of Y, for both ways, without kinks.

    `machine.over_Y` is the same in the units of a machine: its plain positions and forces.
    """

    name = "over_Y"
    takes = "positions, outward, inward=None"
    places = "positions"

    def __call__(
        self,
        positions: Any,
        outward: Any = None,
        inward: Any = None,
        kind: str = "linear",
        *,
        derivative: Callable[[Any], Any] | None = None,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the slider's position; see `help(desaxe.over_Y)`."""
        piston = self.piston(area, bore, ambient)
        if callable(positions) or derivative is not None:
            return load_over("over_Y", "Y", (positions, outward, derivative), self.units, piston)
        return table_over_Y(*self.columns(positions, outward, inward, piston=piston), kind=kind)

    def read(
        self,
        path: Any,
        Y: str | None = None,
        value: str | None = None,
        kind: str = "linear",
        *,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the slider's position from a file or a frame: position, outward and perhaps inward.

        Y, value are the units of the columns; the form of the file is that of `over_theta.read`.
        """
        more = {"kind": kind, "area": area, "bore": bore, "ambient": ambient}
        load: Load = self.from_file(path, {"Y": Y, "value": value}, **more)
        return load


class MakeOverStroke(MakeTable):
    """`over_stroke(distances, outward, inward=None, *, dead_centre)`: a load over the stroke itself.

    The die of a press is hit a given way before bottom dead centre, whatever the design: the load is over the
    slider's distance from a dead centre of *this* design on *this* branch, and moves with it.

        die = dx.over_stroke(["0 mm", "8 mm", "8 mm"], [-80e3, -80e3, 0], [0, 0, 0], dead_centre="outer")

    distances    |Y - Y_dead_centre| >= 0 [m], ascending or descending, or texts with units; one given twice
                 in a linear table is a jump
    outward      the load where Y increases with time, at each distance
    inward       where it decreases; as outward without
    kind         "linear", "step" (a value holds towards larger distances), or "cubic" (extra `simulate`);
                 "linear" without
    dead_centre  required: "outer", the one farthest from the crank, or "inner"

    Forces keep the sign of +Y. Beyond the distances the values at the ends hold. Derivatives by a length
    include how the dead centre moves: dF/dp = F'(d) sign (dY_dc/dp - Y_wrt_p). Where a design has no such
    dead centre forces are NaN, with status 1; at a change point, where the inner one moves infinitely fast
    with the lengths, derivatives with respect to these are, with status 2. `over_stroke.read("press.csv",
    distance="mm", value="kN", dead_centre="outer")` reads the columns distance, outward and, where there is
    one, inward. `over_stroke(f, derivative=None, dead_centre=)` makes a load of a function of the distance.

    `machine.over_stroke` is the same in the units of a machine: its plain distances and forces.
    """

    name = "over_stroke"
    takes = "distances, outward, inward=None, *, dead_centre"
    places = "distances"

    def __call__(
        self,
        distances: Any,
        outward: Any = None,
        inward: Any = None,
        kind: str = "linear",
        *,
        dead_centre: Any = None,
        derivative: Callable[[Any], Any] | None = None,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the distance from a dead centre; see `help(desaxe.over_stroke)`."""
        piston = self.piston(area, bore, ambient)
        if callable(distances) or derivative is not None:
            centre = f"Y_{dead_centre_of(dead_centre)}"
            functions = distances, outward, derivative
            return load_over("over_stroke", "Y", functions, self.units, piston, centre)
        columns = self.columns(distances, outward, inward, piston=piston)
        return table_over_stroke(*columns, kind=kind, dead_centre=dead_centre)

    def read(
        self,
        path: Any,
        distance: str | None = None,
        value: str | None = None,
        kind: str = "linear",
        *,
        dead_centre: Any = None,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the distance from a dead centre from a file: distance, outward and perhaps inward.

        distance, value are the units of the columns; the form of the file is that of `over_theta.read`.
        """
        more = {"kind": kind, "dead_centre": dead_centre, "area": area, "bore": bore, "ambient": ambient}
        load: Load = self.from_file(path, {"distance": distance, "value": value}, **more)
        return load


over_theta = MakeOverTheta()
over_Y = MakeOverY()
over_stroke = MakeOverStroke()
