"""The motion of the crank under a torque.

simulate      the public call
checks        arguments, read and checked
model         a design as functions of its state
coordinate    the coordinate in which a motion is smooth everywhere
equations     the equations of motion
friction      guide friction, which depends on the acceleration that it changes
one_design    one motion by the integrator, step by step, with its events
events        what happens inside a step
many_designs  arrays of designs in one compiled call
energy        motions with the crank angle as the independent variable, where time does not enter
each_design   arrays of designs under loads over the motion, one after the other
stepper       the integrator of one motion
motions       motions of designs one after the other, which numba compiles
state         their state, where it starts and what becomes of it
dop853        one of their steps in time
dense         over a step, and inside of it
tableau       the coefficients of both
panel         panels of the crank angle in between, also from rest
picard        what happens at their nodes
inside_panel  the state inside of one
nodes         their coefficients
compiled      the module of a family of designs
torque        a torque's function, compiled alone
history       histories of angle, speed, quantities and energy
sensitivities  derivatives of an integrated motion by parameters
variational   the linear equations that they obey
rubbing_slopes  the derivatives of the torque that friction takes
work          the derivative of the work
slopes        the derivatives of a torque by angle and speed
cuts          by how much sensitivities jump where a motion is cut
collocation   linear equations along a motion, on panels of time
residual      the energy residual, and a message where it is unusual
result        the result and its statuses
held          loads as functions of time, smooth between their kinks
"""
