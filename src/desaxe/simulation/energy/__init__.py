"""Motions in their energy form: where time does not enter, the crank angle is the independent variable.

serves     where it serves
panels     inertia and torque of designs at the nodes of panels
pieces     a piece of a motion between two kinks or standstills
follow     one motion in plain loops: energy and time as integrals over panels
varied     its derivatives by parameters in plain loops
by_parameters   the derivatives of inertia, torque and start of many designs, and those of their motions
compiled   the same, compiled, for every family of designs
many       many designs, as histories
"""
