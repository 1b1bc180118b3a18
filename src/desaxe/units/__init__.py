"""Units of a mechanism, exactly.

dimensions  units as exponents of m, s, rad and kg, and their texts
table       names of units with their exact sizes, pi to 50 digits, hints for slips of letters
text        numbers with units as text: taken apart, written, reduced
parse       from a text or a pint quantity to an exact number in an SI unit
pint_units  names that the table does not have, and pint's quantities (extra `units`)
scaling     numbers and arrays times exact factors
system      the units of plain numbers: "mm, deg, rpm, kN"
"""

from .pint_units import registry as registry
