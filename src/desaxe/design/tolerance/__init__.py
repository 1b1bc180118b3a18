"""The scatter of a quantity whose inputs have tolerances.

tolerance  the public call
uncertain  inputs with a tolerance or a distribution
"""
