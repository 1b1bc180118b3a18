"""Quantities over one whole turn at constant speed.

turn           samples over a turn
harmonics      Fourier series
counterweight  balancing of the shaking force
flywheel       torque ripple and flywheel inertia
"""
