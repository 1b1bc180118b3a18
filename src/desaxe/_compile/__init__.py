"""`compile`: a scene as source code of its own, in one of several languages.

call      `desaxe.compile`: a scene to files; the text of the Python module
command   `desaxe compile`
portable  a scene as the `Module` that every language writes
solvers   crank angles for a slider position, limit angles
parts     the functions that people call in the Python module
merge     several generated Python modules as one
"""

from .call import compile as compile
from .call import module_text as module_text
from .command import run_compile as run_compile
