"""Design questions: about a whole design, not one crank angle.

feasibility/     can it be assembled, can it turn
events/          dead centres, strokes, time ratio, extreme angles
synthesis/       designs with a required stroke and time ratio
optimisation/    the best design within limits
tolerance/       scatter from tolerances
turn/            harmonics, balancing, flywheel: quantities over one turn
steady/          the steady state of a machine on its motor
solve            an input for a value of the design
inverse          the crank angle for a slider position
design_map       quantities over a space of designs
measures         quantities of a design by name, with derivatives
drive/           torque, power, flywheel and starting torque of a drive
fit/             parameters of a machine from measurements
"""
