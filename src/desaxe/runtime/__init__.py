"""From a request to a callable: points, kernels, machine code.

request        names, inputs and accuracy, checked
specialise     the Program of a request, after all passes
point          a function of floats for single points
kernels        the loop nest of a request, and which designs may take the plain forms
executor       kernels in machine code, over blocks; points that a kernel leaves over, answered again
native_calls   a kernel as a ufunc, a C function, a function for numba, whose points are repaired
threads        parts of a length shared by threads
"""
