"""User-defined quantities: `define`, `undefine`, and the checks of their expressions.

expression  the text of an expression as a tree; nothing is ever evaluated as Python
lowering    a tree as lines of the Program, with the dimension of each part; both sides of a sum agree
conditions  where a quantity may jump or have a kink
define      the calls
tables      definitions in files: `[quantities.NAME]`
"""
