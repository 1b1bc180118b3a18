"""C that the spellings of the C column call, and what stands ahead of it: the .c files beside this one.

No product is fused with a sum in these files, so that all error terms are exact, and every compiler and
option gives the same digits.
"""

from ....support.template import file_text
from ..shared import functions_in


def _text(name: str) -> str:
    return file_text(__package__, name)


PRAGMAS = _text("pragmas.c")  # contraction is switched off as each compiler wants it
CPLUSPLUS = _text("cplusplus.c")  # C++ compiles the file, too, but for a word
HELPERS = functions_in(_text("helpers.c"))
