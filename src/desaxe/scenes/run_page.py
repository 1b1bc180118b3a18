"""The document of `desaxe run --report`: its place, its tolerances, and the command that made it."""

import shlex
from collections.abc import Mapping
from dataclasses import replace
from os.path import abspath
from pathlib import Path

from ..support.shown import printable
from .document.content import DocumentContext, document_of, require_drawing
from .document.spread import read_tolerances
from .document.write import require_document, write_document
from .run import FAILURES, Run, failure
from .scene import Scene


class RunPage:
    """The document beside the files of a run.

    name        its file, .html or .md
    source      the path of the scene
    tolerances  input -> half its range as text
    """

    def __init__(self, name: str, source: str, tolerances: Mapping[str, str], overwrite: bool) -> None:
        self.name, self.tolerances, self.overwrite = name, tolerances, overwrite
        words = ["desaxe", "run", source, "--report", name]
        words += [word for input, half in tolerances.items() for word in ("--tolerance", f"{input}={half}")]
        self.asked = DocumentContext(shlex.join([*words, *["--overwrite"] * overwrite]))

    def require(self, scene: Scene, heard: list[str]) -> None:
        """ValueError or OSError for a place or a tolerance that is bad."""
        require_drawing()
        require_document(Path(self.name), self.overwrite)
        content = scene.content
        others = [content.data, content.store, *(picture.file for picture in content.pictures)]
        if abspath(self.name) in [abspath(other) for other in others if other is not None]:
            raise ValueError(f"--report {printable(self.name)}: another result of the scene is written there")
        found = read_tolerances(content, scene.shown_in, self.tolerances)
        self.asked = self.asked._replace(warnings=tuple(heard), tolerances=found)

    def write(self, scene: Scene, found: Run) -> Run:
        """Write the document, and tell of it, or of why it is not there, with the other files."""
        try:
            document = document_of(scene.content, found, scene.shown_in, self.asked)
            path = write_document(document, Path(self.name), self.overwrite)
        except FAILURES as error:
            return replace(found, failures=(*found.failures, failure(self.name, error)))
        return replace(found, files=(*found.files, path))

    def told(self, found: Run) -> str:
        """The line of the report on its file."""
        return f"Report\n  {printable(self.name)}" if Path(self.name) in found.files else ""
