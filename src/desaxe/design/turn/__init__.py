"""Quantities over one whole cycle of a design.

rows           the inputs of a call as designs in rows
cycle          designs in panels between edges, and how jumps move
turn           one design, checked
harmonics      Fourier series at constant speed
counterweight  balancing of the shaking force
crossings      angles at which a quantity passes through a value
"""
