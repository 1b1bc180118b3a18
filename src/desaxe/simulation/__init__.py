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
history       histories of angle, speed, quantities and energy
residual      the energy residual, and a message where it is unusual
result        the result and its statuses
held          loads as functions of time, smooth between their kinks
loops          motions by DOP853 and by panels, in plain loops whose text numba compiles
derivatives    exact derivatives of an integrated motion by parameters
"""
