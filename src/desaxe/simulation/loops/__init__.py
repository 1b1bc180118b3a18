"""Motions in plain loops, which are compiled: panels of time of one motion, and many motions at once.

advance       panels of time, until something may cut the motion
newton        one of them: the law at its nodes, and Newton's method
motions       motions of designs one after the other, one call for all
state         their state, where it starts and what becomes of it
panel         panels of the crank angle, also from rest
picard        what happens at their nodes
inside_panel  the state inside of one
nodes         their coefficients
compiled      the machine code of all, and the kernel that it calls
torque        a torque's function, compiled alone
values_read   what such a function reads besides its arguments
"""
