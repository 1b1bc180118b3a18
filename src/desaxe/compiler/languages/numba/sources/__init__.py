"""Functions whose text goes into modules of numba; nothing here is imported.

front       loops and functions of arrays of modules that people import
spellings   functions that numba spells in its own way
rooms       buffers and flags of a block of points
given       a function of the user's behind an address
lookups     tables looked up at the points of a block
reductions  reductions of a row
"""
