"""How far a quantity scatters when its inputs do.

tolerance  the public call
uncertain  inputs with a tolerance or a distribution
"""
