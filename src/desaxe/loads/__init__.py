"""Loads over the crank angle or the slider's position: tables, files and functions.

load       what every load is: columns, value, derivatives; tables over theta or Y
arguments  which arguments a user's function is called with, by their names
function   a user's function of theta as a load
table      tables as piecewise cubics
absent     a warning where forces are asked for and nothing acts
words      a load in words
columns    numbers with or without units, from lists and arrays
cells      rows of cells of texts, workbooks and frames, and the numbers of their columns
column_files  columns of files and frames by position or name, with the units of their headings
made       loads made of columns, checked
maker      public calls that make loads and motors, in SI units or a machine's
of_columns  those that make tables of columns, from lists or a file
arithmetic  multiples and sums of loads, loads shifted by an angle
along_motion  loads over columns of the motion: functions, tables over one column, sums of loads
elements   springs and dampers; `spring`, `damper`, `over_V`
units      users' functions in a machine's units
pressure   pressures on a piston as forces
tabulated  `over_theta`, `over_Y`, `over_stroke`: loads from lists, files and functions
motors     a torque over the speed: `over_omega`, `kloss`
stroke     a load over the distance from a dead centre
lines      a load as lines of a Program
angles     crank angles of slider positions and dead centres
resolve    loads as numbers at each point, and total derivatives
"""

from . import arithmetic as arithmetic  # which gives loads their operators
from .elements import damper, over_V, spring
from .load import Load, LoadWarning
from .tabulated import over_stroke, over_theta, over_Y

__all__ = ["Load", "LoadWarning", "damper", "over_V", "over_Y", "over_stroke", "over_theta", "spring"]
