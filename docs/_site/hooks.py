"""What the pages say about the package comes from the package, when the site is built.

A line `<!-- desaxe: WHAT ARGUMENTS -->` is replaced by what the function of that name gives: one of
`formulas` (equations, lines that are computed) or `reference` (functions, scene files, quantities).
"""

import re

import formulas
import reference

MARK = re.compile(r"^<!-- desaxe: (\w+) ?(.*?) -->$", re.M)
WRITERS = {writer.__name__: writer for writer in (*formulas.WRITERS, *reference.WRITERS)}


def on_page_markdown(markdown, **_):
    """The event of MkDocs."""
    return MARK.sub(lambda found: WRITERS[found[1]](*found[2].split()), markdown)
