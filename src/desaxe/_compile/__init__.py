"""`compile`: a scene as a Python module that needs NumPy and numba, and nothing of desaxe.

call    `desaxe.compile`: a scene to the text of its module, and to a file
parts   the functions that people call in it
merge   several generated modules as one
"""

from .call import compile as compile
from .call import module_text as module_text
