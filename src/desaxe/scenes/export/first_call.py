"""Lazy compilation of a written module's loops: at the first call, cached beside the module."""

# The tails of `emit_numba` and `emit_reduced`.
LAZY = '''def kernel(*arrays):
    """The loops, compiled at the first call."""
    return compiled(loops, signature)(*arrays)
'''
LAZY_REDUCED = (
    'kernel = njit(error_model="numpy")(loops)\n',
    '''def reduced(*arrays):
    """The loops and their reductions, compiled at the first call."""
    return compiled(reduced_loops, reduced_signature)(*arrays)
''',
)
COMPILED = '''COMPILED = {}
LOCK = Lock()


def compiled(loops, signature):
    """The loops as machine code, made once and kept beside this file if that can be written."""
    with LOCK:
        if loops not in COMPILED:
            try:
                made = njit(signature, cache=True, error_model="numpy", nogil=True)(loops)
            except RuntimeError:  # numba found no folder that it can write to
                made = njit(signature, error_model="numpy", nogil=True)(loops)
            COMPILED[loops] = made
        return COMPILED[loops]
'''
