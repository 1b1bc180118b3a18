"""User-defined quantities: `define`, `undefine`, and the checks of their expressions.

expression  the text of an expression as lines of the Program, with the dimension of each part
define      the calls
tables      definitions in files: `[quantities.NAME]`
"""
