"""The motion of the crank under a torque.

simulate      the public call
request       what all motions of a call share, and the motion of one design
rows          arrays of designs
checks        arguments, read and checked
model         a design as functions of its state
drive         torque and forces along the motion: values, slopes, smooth pieces
pieces        the pieces of loads for compiled loops
coordinate    the coordinate in which a motion is smooth everywhere
law           the equations of motion, with guide friction
panel         a solved panel of time
march         one motion: compiled loops make panels up to each cut, it rests, fails and ends here
events        the angles to watch for, and those that panels pass
history       histories of angle, speed, quantities and energy
residual      the energy residual, and a message where it is unusual
result        the result and its statuses
slopes        the exact derivatives of a motion by parameters
tangents      the derivatives of a state and its rates, at an instant
shifts        how its cuts move with them
torque_derivative   the derivatives of a torque that is a function
loops         panels, cuts, and many motions in plain loops, which are compiled
"""
