"""A machine: the inputs of a design, frozen, with every public call as a method.

machine    `desaxe.Machine`: a mapping of inputs in SI units, and the units that its owner works in
crankshaft `desaxe.Crankshaft`: several sliders on one crankshaft
methods    the table of public functions that are methods, and how a function becomes one
arguments  what a call is given, in SI units
function   a prepared callable in those units
plots      `machine.plot("a_C")` and the pictures of `desaxe.plot`
scenes     a machine from a scene, and a scene from a machine
crankshaft_report  the page with everything about a crankshaft
report     the page with everything about a machine
summary    how a machine shows itself: drawing, lengths, speed, masses, loads, stroke
"""

from .machine import Machine as Machine
