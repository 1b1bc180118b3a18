"""A Program as JavaScript: one function of numbers, for a page that is open in a browser.

JavaScript numbers are doubles, and its arithmetic is that of IEEE 754: the same operations in the same
order give the same digits as plain Python, up to the last bit of a sine or cosine.
"""

from ...support.template import file_text
from ..program import Program
from ..text import with_short_temporaries, write_lines

INDENT = "  "
# Names that the readable text has and JavaScript has not, and the helpers, once on a page: it has no copysign
# and no fused multiply-add, so that Dekker's product stays.
HEADER = file_text(__package__, "javascript.js")
TABLES = file_text(__package__, "javascript_tables.js")  # the helpers of tables, for modules that have some


def emit_javascript(program: Program, name: str = "point") -> str:
    """The source of `name(...inputs)`, which returns an array of the outputs; `HEADER` must precede it."""
    lines = map(_statement, write_lines(with_short_temporaries(program), "javascript"))
    body = [*lines, f"return [{', '.join(program.outputs)}];"]
    head = f"function {name}({', '.join(program.inputs)}) {{"
    return "\n".join([head, *(INDENT + line for line in body), "}"]) + "\n"


def _statement(line: str) -> str:
    """An assignment of the readable text as a declaration."""
    assignment, mark, note = line.partition("  # ")
    return f"const {assignment};" + (f" // {note}" if mark else "")
