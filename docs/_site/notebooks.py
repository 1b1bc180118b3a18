"""The notebooks as pages of the site: their text, code and stored outputs."""

import json
from html import escape
from pathlib import Path

from latex2mathml.converter import convert

FOLDER = Path(__file__).parents[2] / "notebooks"
LONGEST = 60_000  # characters of an HTML output; longer ones, such as animations, are shown as text


def pages():
    """Address of each notebook's page -> its Markdown."""
    return {f"notebooks/{path.stem}.md": _page(path) for path in sorted(FOLDER.glob("*.ipynb"))}


def title(page):
    """The heading of a page."""
    return page.partition("\n")[0].removeprefix("# ")


def _page(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    head, *others = (part for cell in cells for part in _parts(cell))
    note = f"`notebooks/{path.name}` of the repository, with its stored outputs."
    return "\n\n".join([head.rstrip(), note, *others]) + "\n"


def _parts(cell):
    text = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        yield text.replace("](../docs/", "](../").replace(".ipynb)", ".md)")  # as pages of the site
    elif text:
        yield f"```python\n{text}\n```"
        yield from map(_output, cell["outputs"])


def _output(output):
    data = {kind: "".join(text) for kind, text in output.get("data", {}).items()}
    if "image/png" in data:
        return f'<img alt="Output of the cell above" src="data:image/png;base64,{data["image/png"].strip()}">'
    if "text/markdown" in data:
        return data["text/markdown"]
    if "text/latex" in data:
        return f"<p>{convert(data['text/latex'].strip('$ '))}</p>"
    if len(data.get("text/html", "")) in range(1, LONGEST):
        return f"<div>{''.join(data['text/html'].splitlines())}</div>"
    return f"<pre><code>{escape(data.get('text/plain') or ''.join(output.get('text', ())))}</code></pre>"
