"""Quantities over one whole cycle of a design.

cycle          designs in panels between edges, and how jumps move
turn           one design, checked
harmonics      Fourier series at constant speed
counterweight  balancing of the shaking force
crossings      angles at which a quantity passes through a value
"""
