"""Words that no name in a written file can be: the sections of words.txt.

Where a language has a function for each output, one of such a name would take the place of what the file
calls; a file of such a name, that of a module, header or function that it needs. Both are refused by name.
"""

import keyword
import re
import sys
from functools import cache
from typing import NamedTuple

from ...support.template import file_text


class Words(NamedTuple):
    """Words that no line of a program is called (it gets an underscore), nor an output, nor a module."""

    lines: frozenset[str] = frozenset()
    outputs: frozenset[str] = frozenset()
    modules: frozenset[str] = frozenset()


@cache
def words_of(language: str) -> Words:
    """The table of a language."""
    own = _section(language)
    lines = own | _section("loads")
    # What a Python module imports, and what that imports in turn.
    imported = frozenset((*sys.stdlib_module_names, "jax", "jaxlib", "llvmlite", "numba", "numpy"))
    return {
        "c": Words(lines, modules=_section("c.modules")),
        "jax": Words(lines | {*keyword.kwlist}, lines | {*keyword.kwlist}, imported),
        "javascript": Words(lines, lines),
        "numba": Words(outputs=own | {*keyword.kwlist}, modules=imported),
        "octave": Words(lines, modules=own),
    }[language]


def _section(name: str) -> frozenset[str]:
    text = re.sub(r"#.*", "", file_text(__package__, "words.txt"))
    return frozenset(text.partition(f"[{name}]")[2].partition("[")[0].split())
