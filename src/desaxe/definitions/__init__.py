"""User-defined quantities: `define`, `undefine`, and their parser and checks.

grammar     the text of an expression as a tree; nothing is ever evaluated as Python
dimensions  the dimension of every part of a tree; both sides of a sum agree
units       constants such as "1 mm" as SI numbers, without a unit library
lines       a tree as lines of the Program
define      the calls
tables      definitions in files: `[quantities.NAME]`
"""
