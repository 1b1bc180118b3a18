"""The options of a written module, and the languages that have them."""

from typing import NamedTuple

from ...compiler.languages import languages
from ...support.shown import shown

TABLES = 'tables="arguments" (--tables arguments)'
_OPTIONS = " --no-libm", " --float", " --tables arguments"
_KEYWORDS = ", libm=False", ", float=True", ', tables="arguments"'


class Form(NamedTuple):
    """The options of a written module: without libm, in single precision, with tables as arguments."""

    freestanding: bool = False
    single: bool = False
    open_tables: bool = False

    @property
    def options(self) -> str:
        """The options as the command line has them."""
        return "".join(text for text, chosen in zip(_OPTIONS, self, strict=True) if chosen)

    @property
    def keywords(self) -> str:
        """The options as `compile` has them."""
        return "".join(text for text, chosen in zip(_KEYWORDS, self, strict=True) if chosen)


PLAIN = Form()


def are_open(tables: str) -> bool:
    """Whether tables are arguments; ValueError for another word than the two that there are."""
    if tables not in ("frozen", "arguments"):
        raise ValueError(f"tables = {shown(tables)}: it is one of frozen, arguments")
    return tables == "arguments"


def those_with(has: str) -> str:
    """The languages that have something, listed."""
    names = (one.name for one in languages() if getattr(one, has))
    return " and ".join(", ".join(names).rsplit(", ", 1))
