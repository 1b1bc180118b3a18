"""Machine code: made once by numba, stored, loaded by LLVM alone.

modules        text -> digest -> lock -> file -> machine code, for peaks and simulation
compiled_text  a text through numba and LLVM to machine code
parts          numba's target for the functions of a text
machine_code   self-contained machine code, loaded without numba
loader         LLVM as a loader, without the Python of llvmlite
"""
