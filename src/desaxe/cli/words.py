"""Command-line arguments as names of quantities and inputs; UsageError for any other."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from ..support.extras import MissingExtraError


class UsageError(Exception):
    """The command line cannot be understood."""


def names_and_inputs(words: Sequence[str]) -> tuple[list[str], dict[str, Any]]:
    """Split arguments into names and inputs; an argument with = is an input."""
    from ..mechanism.inputs import INPUTS

    names: list[str] = []
    inputs: dict[str, Any] = {}
    for before, word in pairwise(["", *words]):
        key, equals, value = (part.strip() for part in word.partition("="))
        if not equals:
            _refuse_parted(before, word)
            names += [name for name in word.split(",") if name]
        elif not (key and value):
            raise UsageError(f"{word}: an input and its value are one word, such as theta=60deg")
        elif key == "branch":
            inputs[key] = _branch(value)
        elif key not in INPUTS:
            raise UsageError(f"{word}: no input is called {key!r}, {_inputs_near(key)}")
        elif key in inputs:
            raise UsageError(f"{word}: {key} is given twice")
        else:
            inputs[key] = _quantity(word, value)
    if not names:
        raise UsageError("which quantity? give a name such as a_C (desaxe point --list shows all)")
    return list(dict.fromkeys(names)), inputs


def _inputs_near(word: str) -> str:
    """All input names, the one most similar to a wrong name first."""
    from ..mechanism.inputs import INPUTS
    from ..mechanism.spelling import did_you_mean

    asked = did_you_mean(word, (*INPUTS, "branch"))
    return f"{asked}{'There' if asked else 'there'} are {', '.join([*INPUTS, 'branch'])}"


def _refuse_parted(before: str, word: str) -> None:
    """UsageError if the shell split `ec=10 mm` in two: the second argument is then a unit."""
    from ..mechanism.catalogue import quantities

    key, equals, value = before.partition("=")
    if not equals or word in quantities():
        return
    from ..mechanism.inputs import INPUTS
    from ..mechanism.read import in_si

    try:
        float(value)
        in_si(INPUTS[key], f"{value} {word}")
    except (ValueError, KeyError, MissingExtraError):
        return
    raise UsageError(
        f'{before} {word}: a value and its unit are one word, {before}{word} or "{before} {word}"'
    )


def _quantity(word: str, text: str) -> str:
    from ..units.text import quantity_text

    try:
        return quantity_text(text)
    except ValueError as error:
        raise UsageError(f"{word}: {error}") from None


def _branch(text: str) -> int:
    if text not in ("1", "+1", "-1"):
        raise UsageError(f"branch={text}: it is 1 or -1")
    return int(text)
