"""`compile`: a scene as a Python module that needs NumPy and numba, and nothing of desaxe.

compile       `desaxe.compile`: a scene to the text of its module, and to a file
entry_points  the functions that people call in it
merge         several generated modules as one
"""
