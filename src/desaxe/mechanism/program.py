"""The committed program, sliced to the requested names.

Reads the text of generated/program.py: only the lines that the requested names need are parsed, so
the first answer of a process comes quickly.
"""

from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from ..compiler.passes.bind import assume, overlay
from ..compiler.passes.slicing import keep_outputs
from ..compiler.program import Program
from ..compiler.text import ProgramText
from ..support.forks import imported
from .load_lines import Under
from .names import parts
from .own import Definition, used_by
from .own_lines import lines_needed, with_own_lines


class Variant(NamedTuple):
    """A variant of the program: law or given state, centres of mass, plain or stable form."""

    state: bool = False  # a given state instead of paper A's law
    default_centres: tuple[str, ...] = ()  # centres of mass halfway along their links
    wide_margins: bool = False  # plain forms, for designs with AB + |ec| < 7/8 BC, where nothing cancels
    own: tuple[Definition, ...] = ()  # quantities of a user's own that are among the names, or behind them
    under: Under | None = None  # loads that vary with the motion, of which the content is known at run time


@cache
def _text(name: str) -> ProgramText:
    spec = find_spec("desaxe.generated")
    if spec is None or spec.origin is None:
        raise ImportError("desaxe.generated is missing: the installation is incomplete")
    return ProgramText((Path(spec.origin).parent / f"{name}.py").read_text(encoding="utf-8"))


LAW = Variant()  # paper A's law, every centre of mass given


def program_of(names: tuple[str, ...], form: Variant = LAW) -> Program:
    """The program of these names (of the law) in one variant, with user-defined quantities as of now.

    Its outputs stand in the order of the names; `line_name` says what those of own quantities are called.
    """
    return _program_of(names, form if form.own else form._replace(own=used_by(names)))


@lru_cache(maxsize=1024)
def _program_of(names: tuple[str, ...], form: Variant) -> Program:
    bases = {definition.name for definition in form.own}
    own = tuple(name for name in names if parts(name)[0] in bases)
    if own:
        others = (*(name for name in names if name not in own), *lines_needed(own, form.own).names)
        base = _program_of(tuple(dict.fromkeys(others)), form._replace(own=()))
        return with_own_lines(base, names, form.own)
    if form.default_centres:
        inputs, halfway = _program_of(names, form._replace(default_centres=())), _text("centres").read()
        moved = [name for name in halfway.outputs if name.startswith(form.default_centres)]
        return overlay(inputs, keep_outputs(halfway, moved))
    if form.state:
        return overlay(_program_of(names, form._replace(state=False)), _text("state").read())
    return assume(_text("program").read(names), {"wide_margins": form.wide_margins})


@cache
def whole_program() -> Program:
    """Every line of the derivation, under the law."""
    return _text("program").read()


@cache
def digest() -> str:
    """The digest of the derivation and compiler that wrote generated/."""
    value: str = imported("desaxe.generated").DIGEST
    return value
