"""Torque, power and flywheel of a drive over a cycle.

drive     `desaxe.drive`: torque, power, work, flywheel and starting torque of one design
inertia   of a flywheel for a required fluctuation of speed, friction included, and its derivatives
result    the dict that `drive` returns, its report and its plot
"""
