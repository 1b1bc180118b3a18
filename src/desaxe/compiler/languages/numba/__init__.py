"""Self-contained numba modules.

language    numba behind the Protocol of all languages
library     a module that people import: point, evaluate, grid
module      functions in text, behind all that they call
sources/    functions whose text goes into a module
"""
