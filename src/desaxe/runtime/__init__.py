"""From a request to a callable: points, kernels, cache, machine code.

request        names and inputs, checked
accuracy       the accuracies and their bounds
specialise     the Program of a request, after all passes
point          a function of floats for single points
kernels        compiled loops for arrays
cache          the folder of compiled kernels
wide_margins   which designs may take the plain forms
executor       kernels in machine code
left_over      points that a kernel leaves over, answered again
native_calls   a kernel as a ufunc, a C function, a function for numba
threads        blocks of an array shared by threads
native         machine code: made once by numba, stored, loaded by LLVM alone
"""
