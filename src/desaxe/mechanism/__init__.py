"""The slider-crank by name: inputs, quantities, status codes, the committed program.

names         names of sensitivities, and the lists of parameters; units of derivatives
inputs        the inputs: meaning, unit, limits; units of other arguments and results
catalogue     the quantities and sensitivities: unit, meaning, source
read          one reader of numbers, with or without a unit
keywords      unknown keywords, refused with the one that was meant
spelling      the name that was meant by one that does not exist
program       the committed Program, sliced to some names, and its variants
constants     coefficients of the written-out sine and cosine
closed        closed forms of the geometry as Programs: limit angles, dead centres, the inverse
status        the status codes of every call, with their words
quantity_units  units of inputs, quantities and their derivatives, in SI and in any system
messages      texts that know which of their numbers are quantities, for a front end's units
ranges        `between` and `plus_minus`: inputs with a range or tolerance
public        public functions, which warn of slips of units: sizes that are typical
slips         plain numbers that are almost certainly in another unit
own           user-defined quantities: the register
own_lines     their lines in the Program, with derivatives
load_lines    loads over the motion as lines of a Program, and total derivatives
"""
