"""Functions whose text goes into modules of numba; nothing here is imported.

front       loops and functions of arrays of modules that people import
spellings   functions that numba spells in its own way
"""
