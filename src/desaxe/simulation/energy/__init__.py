"""Motions in their energy form: where time does not enter, the crank angle is the independent variable.

serves     where it serves
panels     inertia and torque of designs at the nodes of panels
motion     the motion of one design up to its end, with its events, and its result
path       the pieces of that motion: when it passes angles and stands still
many       many designs, as histories
course     their speeds, accelerations and energies
loops      the energy form in plain loops, which are compiled
"""
