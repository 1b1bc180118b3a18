"""Hooks of MkDocs: generated parts of pages, and equations.

A line `<!-- desaxe: WRITER -->` is replaced by the text that the function of `reference` of that name
returns, a block of LaTeX by a drawing.
Inline LaTeX in GitHub's notation, a code span between dollar signs, becomes MathML, which needs no script.
Each notebook becomes a page.
"""

import re
from html import unescape

import formulas
import reference
from latex2mathml.converter import convert
from mkdocs.structure.files import File

import notebooks

MARK = re.compile(r"^<!-- desaxe: (\w+) ?(.*?) -->$", re.M)
PUBLIC = re.compile(r"^\| (`(desaxe[\w.]+)`) \|", re.M)
MATHS = re.compile(r"\$<code>(.+?)</code>\$", re.S)
NOTEBOOK = re.compile(r"\(\.\./notebooks/(\w+)\.ipynb\)")
BLOCK = re.compile(r"^```math\n(.+?)\n```$", re.S | re.M)
WRITERS = {writer.__name__: writer for writer in reference.WRITERS}


def on_config(config, **_):
    """List the notebooks in the navigation, after the first steps."""
    listed = {"Notebooks": [{notebooks.title(page): path} for path, page in notebooks.pages().items()]}
    next(door["Learn"] for door in config.nav if "Learn" in door).append(listed)
    return config


def on_files(files, config, **_):
    """Add the page of each notebook."""
    for path, page in notebooks.pages().items():
        files.append(File.generated(config, path, content=page))
    return files


def on_page_markdown(markdown, **_):
    """Replace the marks of a page before it is converted to HTML; names in tables lead to their entries.

    Links to a notebook of the repository lead to its page.
    """
    markdown = NOTEBOOK.sub(r"(notebooks/\1.md)", markdown)
    markdown = PUBLIC.sub(lambda row: f"| [{row[1]}](#{row[2].replace('.', '').lower()}) |", markdown)
    markdown = BLOCK.sub(lambda block: formulas.drawing_of(block[1]), markdown)
    return MARK.sub(lambda found: WRITERS[found[1]](*found[2].split()), markdown)


def on_page_content(html, **_):
    """Replace the inline LaTeX of a converted page by MathML."""
    return MATHS.sub(lambda found: f'<span class="math">{convert(unescape(found[1]))}</span>', html)
