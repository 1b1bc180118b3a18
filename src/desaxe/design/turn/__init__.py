"""Quantities over one whole cycle of a design.

turn           the design, checked: its quantities at equal steps and in panels
panels         a turn in panels on which everything is a polynomial: integrals, roots, extremes
harmonics      Fourier series at constant speed
counterweight  balancing of the shaking force
"""
