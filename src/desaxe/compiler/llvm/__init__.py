"""Kernels to machine code by LLVM, in memory.

ir             operations and loops as LLVM's text
nest           a Kernel as a module: the entry, its loops, its two forms
two_forms      loops over blocks of points of which each takes one of two forms
functions.ll   what they call; loop.ll, blocks.ll: the loops
tables         tables.ll, the look-ups, at one point and at those of a vector
loops          Python's own loops over arrays, compiled
statements     their statements
expressions    their expressions
machine        text to machine code, which the caller keeps alive
"""
