"""Functions whose text goes into modules of numba; nothing here is imported.

front       loops and functions of arrays of modules that people import
spellings   functions that numba spells in its own way
rooms       buffers of numbers
given       a function of the user's behind an address
"""
