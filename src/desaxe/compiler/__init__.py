"""The compiler: a frozen Program, passes over it, and emitters. No SymPy, nothing of the library.

    operations  the operation table: meaning, spellings, cost, one row each
    program     Program, a list of single assignments, and its canonical form
    text        a Program as readable Python, and back, parsing only what is needed
    helpers     functions that spellings call, in plain Python
    builder     modules as text: parts, what they call from real files, imports
    interpret   a Program run exactly (mpmath) or in IEEE doubles
    passes      Program -> Program, one module each
    lowering    the stages from a Program to machine code, in their order: read this first
    kernel      a loop nest whose bodies are Programs
    llvm        machine code in memory, what the library itself runs
    languages   Python, numba, C, jax, Octave and JavaScript, one file or folder each
    forms       plain and stable lines as one program, set apart in a kernel

The room imports nothing of the library but `support`. To add an operation, add its row; a
language, its column and its file in `languages`; a pass, its module and its
entry in `passes.pipeline.PASSES`.
"""
