"""The motion of the crank under a torque.

simulate      the public call
request       the motion of one design
rows          arrays of designs
checks        arguments, read and checked
coordinate    the coordinate in which a motion is smooth everywhere
model         a design as functions of its state
drive         torque and forces along the motion: numbers, loads, motors, and functions that loops call
pieces        torque and forces as numbers for compiled loops
law           the equations of motion: the numbers of a design, and states under them
panel         the record of a motion: panels of time
march         one motion: compiled loops make panels up to each cut, it rests, fails and ends here
events        the angles to watch for, and those that panels pass
history       histories of angle, speed, quantities and energy, and the energy residual
result        the result and its statuses
slopes        the exact derivatives of a motion by parameters
tangents      the derivatives of a state and its rates, at an instant
shifts        how its cuts move with them
loops         panels, cuts, and many motions in plain loops, which are compiled
"""
