"""The documentation: every Python block runs, the site builds without a warning."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.S | re.M)
PAGES = sorted(
    path.relative_to(ROOT).as_posix() for path in [*(ROOT / "docs").glob("*.md"), ROOT / "README.md"]
)
WITH_BLOCKS = [page for page in PAGES if BLOCK.search((ROOT / page).read_text(encoding="utf-8"))]


@pytest.mark.parametrize("page", WITH_BLOCKS)
def test_its_python_runs(page, tmp_path, monkeypatch):
    """In the order of the page, as one program; what it writes goes elsewhere."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    text, scope = (ROOT / page).read_text(encoding="utf-8"), {}
    for block in BLOCK.finditer(text):
        line = text.count("\n", 0, block.start(1))
        exec(compile("\n" * line + block[1], page, "exec"), scope)


def test_the_pages_that_should_have_python_do():
    wanted = {
        "README",
        *(f"docs/{name}" for name in ("index", "howto", "choose", "coming-from", "promise", "scene")),
    }
    assert wanted <= {page.removesuffix(".md") for page in WITH_BLOCKS}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built as strictly as there is."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    plain = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=plain, check=False)
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    return folder


def test_every_page_is_there(site):
    pages = {path.parent.name for path in site.rglob("index.html")}
    assert {Path(page).stem for page in PAGES if page.startswith("docs/")} - {"index"} <= pages


def test_what_is_generated_stands_in_it(site):
    text = {
        name: (site / name / "index.html").read_text(encoding="utf-8")
        for name in ("derivation", "api", "scene")
    }
    assert not [name for name in text if "desaxe: " in re.sub(r"<pre>.*?</pre>", "", text[name], flags=re.S)]
    assert text["derivation"].count('class="equation"') == 12
    import desaxe as dx

    assert all(f"desaxe.{name}" in text["api"] for name in dx.__all__)
    assert "m_slider" in text["scene"]


def test_links_lead_somewhere(site):
    """To files that are in the site, or out of it."""
    broken = []
    for page in site.rglob("index.html"):
        links = re.findall(r'(?:href|src)="([^"#?]+)', page.read_text(encoding="utf-8"))
        local = [link for link in links if not re.match(r"[a-z]+:|//|/", link)]
        broken += [(page.name, link) for link in local if not (page.parent / link).exists()]
    assert not broken
