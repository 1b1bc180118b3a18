"""Self-contained numba modules.

language    numba as a language
library     a module that people import: point, evaluate, grid
sources/    functions whose text goes into a module
"""
