"""Torque, power and flywheel of a drive over a cycle.

drive     `desaxe.drive`: torque, power, work, flywheel and starting torque of one design
panels    a turn in panels on which everything is a polynomial: integrals, roots, extremes
cycle     the torque of a design over its turn, on such panels
flywheel  the inertia for a required fluctuation of speed, friction included, and its derivatives
result    the dict that `drive` returns, its report and its plot
"""
