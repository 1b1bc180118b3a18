"""A Program as JavaScript: one function of numbers, for a page that is open in a browser.

JavaScript numbers are doubles, and its arithmetic is that of IEEE 754: the same operations in the same
order give the same digits as plain Python, up to the last bit of a sine or cosine.
"""

from ...support.template import file_text
from ..program import Program
from .shared import Spelling, with_safe_names

INDENT = "  "
# Names that the readable text has and JavaScript has not, and the helpers, once on a page: it has no copysign
# and no fused multiply-add, so that Dekker's product stays.
HEADER = file_text(__package__, "javascript.js")
TABLES = file_text(__package__, "javascript_tables.js")  # the helpers of tables, for modules that have some


SPELLING = Spelling("javascript", "const {name} = {right};", " // {}")


def emit_javascript(program: Program, name: str = "point") -> str:
    """The source of `name(...inputs)`, which returns an array of the outputs; `HEADER` must precede it."""
    safe = with_safe_names(program, SPELLING.reserved)
    body = [*SPELLING.statements(program), f"return [{', '.join(safe.outputs)}];"]
    head = f"function {name}({', '.join(safe.inputs)}) {{"
    return "\n".join([head, *(INDENT + line for line in body), "}"]) + "\n"
