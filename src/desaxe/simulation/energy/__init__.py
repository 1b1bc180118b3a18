"""Motions in their energy form: where time does not enter, the crank angle is the independent variable.

serves     where it serves
panels     inertia and torque of designs at the nodes of panels
motion     the motion of one design up to its end, with its events
path       the pieces of that motion: when it passes angles and stands still
alone      the result of one design, with the derivatives of its events, end and work
pushed     the derivatives of torque, load and limit angles of many designs by parameters
by_parameters   those of their fields and starts, and the motions with them
along      the derivatives of histories, ends and work
many       many designs, as histories
course     their speeds, accelerations and energies
one_design  the context in which a motion of one design compiles nothing for its family
loops          the energy form in plain loops, which are compiled
"""
