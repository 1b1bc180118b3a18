"""Languages: each writes the same Module in its own way, behind one class.

protocol    what is written (`Module`), and what a language must have (`Language`)
shared      assignments as statements, comments
lifted      sines and cosines of arguments as arguments
words       names that a language, or what it writes, keeps for itself
c/          C99: a header and a source, no allocation, no global state
jax         Python over jax.numpy, with derivatives by name
octave      one vectorised function for GNU Octave and MATLAB; octave.m has what spellings call
es_module   a JavaScript module and its types
javascript  one JavaScript function, for the explorer and for the module
python      plain Python over `math`, for single points
arrays      Python over NumPy, for some points at once
numba/      self-contained modules of compiled loops

A new language is a file or folder here and its column of the operation table; `languages` lists it.
"""

from typing import TYPE_CHECKING

from ...support.forks import IMPORTS
from ...support.shown import shown

if TYPE_CHECKING:
    from .protocol import Language


def languages() -> "tuple[Language, ...]":
    """All languages, imported when they are asked for: a kernel needs none of them."""
    with IMPORTS:
        from .c import C
        from .es_module import JavaScript
        from .jax import Jax
        from .numba.language import Numba
        from .octave import Octave

    return Numba(), C(), Jax(), Octave(), JavaScript()


def language_of(name: str, *others: str) -> "Language":
    """The language of this name; ValueError with those that there are, and `others` that the caller takes."""
    known = {language.name: language for language in languages()}
    if not isinstance(name, str) or name not in known:
        raise ValueError(f"to = {shown(name)}: it is one of {', '.join((*known, *others))}")
    return known[name]
