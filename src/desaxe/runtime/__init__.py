"""From a request to a callable: points, kernels, cache, machine code.

request       names and inputs, checked
accuracy      the accuracies that can be asked for
specialise    the Program of a request, after all passes
point         a function of floats for single points
interpreted   few points in plain Python
kernels       compiled loops for arrays
modules       text -> digest -> lock -> file -> machine code, for kernels, peaks and simulation
compiled_text  a text through numba and LLVM to machine code
machine_code  machine code that stands alone, loaded without numba
loader        LLVM as a loader, without the Python of llvmlite
cache         the folder of compiled kernels
written       which files desaxe wrote, and may replace
wide_margins  which designs may take the plain forms
near_limit    points at which rounding decides whether the rod reaches
threads       blocks of an array shared by threads
"""
