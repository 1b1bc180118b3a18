"""The slider-crank by name: inputs, quantities, units, status codes, the committed program.

names         names of sensitivities, and the lists of parameters
inputs        the inputs: meaning, unit, limits
catalogue     the quantities and sensitivities: unit, meaning, source
units         text and pint quantities as SI numbers
spelling      the name that was meant by one that does not exist
program       the committed Program, sliced to some names, and its variants
constants     coefficients of the written-out sine and cosine
limit_angles  the crank angles at which the mechanism can be assembled
"""
