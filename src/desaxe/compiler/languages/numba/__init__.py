"""Kernels as self-contained numba modules.

language    numba behind the Protocol of all languages
module      a loop nest that fills its outputs
library     a module that people import: point, evaluate, grid
two_forms   the inner loops of a kernel that has a plain and a stable form
lookups     the inner loops of a kernel that looks tables up
reductions  kernels that keep the largest, the mean, ... of the innermost axis
sources/    functions whose text goes into a module
"""
