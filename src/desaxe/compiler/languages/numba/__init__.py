"""Kernels as self-contained numba modules.

module      a loop nest that fills its outputs
two_forms   the inner loops of a kernel that has a plain and a stable form
rooms       the buffers and flags of such a kernel, as text of its module
reductions  kernels that keep the largest, the mean, ... of the innermost axis
peaks       the functions of a quantity that a search over theta calls
"""
