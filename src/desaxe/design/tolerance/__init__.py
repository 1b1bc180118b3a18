"""The scatter of a quantity whose inputs have tolerances.

tolerance  the public call
scatter    the dict that is returned, and its lines
function   a quantity as a function of its inputs, with slopes; whether it is smooth and without a jump
uncertain  inputs with a tolerance or a distribution
"""
