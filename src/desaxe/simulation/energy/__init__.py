"""Motions in their energy form: where time does not enter, the crank angle is the independent variable.

serves     where it serves
panels     inertia and torque of designs at the nodes of panels
instants   where motions are at instants, in plain loops
at_angles  quantities of many designs at angles, in plain loops
motion     the motion of one design up to its end, with its events
path       the pieces of that motion: when it passes angles and stands still
alone      the result of one design, with the derivatives of its events, end and work
pieces     a piece of a motion between two kinks or standstills
follow     one motion in plain loops: energy and time as integrals over panels
course     speeds, accelerations and energies along motions, in plain loops
turns      whole turns without an instant, many at once, in plain loops
through    derivatives of time and energy through whole panels and many turns, in plain loops
partly     the same on other pieces, such as those next to a standstill
varied     its derivatives by parameters in plain loops
pushed     the derivatives of torque, load and limit angles of many designs by parameters
by_parameters   those of their fields and starts, and the motions with them
along      the derivatives of histories, ends and work
compiled   the same, compiled, for every family of designs
many       many designs, as histories
"""
