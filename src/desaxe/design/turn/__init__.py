"""Quantities over one whole cycle of a design.

turn           the design, checked: its quantities at equal steps and in panels
harmonics      Fourier series at constant speed
counterweight  balancing of the shaking force
"""
