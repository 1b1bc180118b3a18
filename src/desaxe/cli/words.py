"""Command-line arguments as names of quantities and inputs; UsageError for any other."""

from collections.abc import Sequence
from contextlib import suppress
from itertools import pairwise
from typing import Any

from ..support.extras import MissingExtraError


class UsageError(Exception):
    """The command line cannot be understood."""


VALUED = ("--machine", "--units", "-o")  # options of a call whose value is the next word
PLAIN = ("--json", "--csv", "--overwrite", "--list", "--help", "-h")
FLAGS = ("--quality",)  # options of functions that are true
TABLES = ("over", "sigma", "nuisance", "loss")  # and those that have values


def options_first(words: Sequence[str]) -> list[str]:
    """The words of a call with its options, which may stand anywhere, ahead of names and inputs.

    `--over AB=35:50 --loss huber` is `over.AB=35:50 loss=huber`; a scene without `--machine` is the machine.
    """
    options: list[str] = []
    others: list[str] = []
    tables: dict[str, list[str]] = {}
    values: list[str] = others  # where the next word belongs
    for before, word in pairwise(["", *words]):
        key = word.removeprefix("--")
        if key != word and key in TABLES:
            values = tables.setdefault(key, [])
        elif word in PLAIN or word in VALUED or before in VALUED:
            options.append(word)
            values = others
        elif word in FLAGS:
            others.append(f"{key}=true")
            values = others
        elif key != word:
            options.append(word)
        elif word.endswith(".toml") and values is others and "--machine" not in words:
            options += ["--machine", word]
        else:
            if values and "=" in word and values is tables.get("loss"):  # an input behind a value
                values = others
            values.append(word)
    for key, parts in tables.items():
        if not parts:
            raise UsageError(f"--{key}: expected values, such as --over AB=30mm:60mm")
        if any("=" in part for part in parts):
            others += [f"{key}.{part}" if "=" in part else f"{key}.{part}=none" for part in parts]
        else:
            others.append(f"{key}={','.join(parts)}")
    return [*options, *others]


def arguments_of(words: Sequence[str]) -> tuple[list[str], dict[str, Any]]:
    """Split arguments into names and arguments of a call; `over.ec=LOW:HIGH` is an entry of `over`."""
    names: list[str] = []
    arguments: dict[str, Any] = {}
    keys: set[str] = set()
    for before, word in pairwise(["", *words]):
        key, equals, text = (part.strip() for part in word.partition("="))
        if not equals:
            _refuse_parted(before, word)
            names += [name for name in word.split(",") if name]
            continue
        if not (key and text):
            raise UsageError(f"{word}: an input and its value are one word, such as theta=60deg")
        if key in keys:
            raise UsageError(f"{word}: {key} is given twice")
        keys.add(key)
        head, dot, entry = key.partition(".")
        table = arguments.setdefault(head, {} if dot else _value(word, text))
        if dot and isinstance(table, dict):
            table[name_of(entry)] = _value(word, text)
        elif dot or isinstance(table, dict):
            raise UsageError(f"{word}: {head} has a value already")
    return list(dict.fromkeys(names)), arguments


def _value(word: str, text: str) -> Any:
    """A number, a text, a list with commas, a pair LOW:HIGH, or the numbers of FIRST:LAST:COUNT."""
    if "," in text:
        values = [_value(word, part) for part in text.split(",") if part]
        if isinstance(values[-1], str) and isinstance(values[0], (int, float)) and text[-1:].isalpha():
            raise UsageError(
                f"{word}: it must be a number, or a number with a unit: 1.5 has a point, and in a list of "
                "numbers each has its unit"
            )
        return values
    parts = text.split(":")
    if len(parts) == 2 and "" in parts:
        ends = ":".join(part or "none" for part in parts)
        raise UsageError(f"{word}: an open side is none: {word.partition('=')[0]}={ends}")
    if len(parts) == 3:
        return _range(word, *parts)
    from ..mechanism.ranges import plus_minus
    from ..units.text import PLUS_MINUS

    value, *tolerance = (_single(part.strip()) for part in PLUS_MINUS.split(text))
    if len(tolerance) == 1:
        return plus_minus(value, *tolerance)
    return tuple(map(_single, parts)) if len(parts) == 2 else _single(text)


def _single(text: str) -> Any:
    """True, False, None, a number, or the text as it is: of a quantity, or a word such as `kind=max`."""
    if text in ("true", "false", "none"):
        return {"true": True, "false": False}.get(text)
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


def name_of(entry: str) -> Any:
    """The key of an entry: a name, or a pair such as `absmax:a_C`."""
    parts = entry.split(":")
    return tuple(parts) if len(parts) > 1 else entry


def _range(word: str, first: str, last: str, count: str) -> list[Any]:
    """Evenly spaced numbers, both ends included, with the unit that both ends have."""
    from fractions import Fraction

    from ..scenes.reading.spread import spread
    from ..units.text import quantity_text

    try:
        (start, _, unit), (stop, _, other) = (quantity_text(end).partition(" ") for end in (first, last))
        if (unit and other and unit != other) or not int(count) > 1:
            raise ValueError
        values = spread(Fraction(start), Fraction(stop), int(count) - 1)
    except ValueError:
        raise UsageError(f"{word}: expected FIRST:LAST:COUNT, such as 0deg:360deg:73") from None
    unit = unit or other
    return [f"{value!r} {unit}" if unit else value for value in values]


def _refuse_parted(before: str, word: str) -> None:
    """UsageError if the shell split `ec=10 mm` in two: the second argument is then a unit."""
    from ..mechanism.catalogue import has

    key, equals, value = before.partition("=")
    if not equals or has(word):
        return
    from ..mechanism.inputs import INPUTS
    from ..mechanism.read import in_si

    with suppress(ValueError, KeyError, MissingExtraError):
        float(value)
        in_si(INPUTS[key], f"{value} {word}")
        raise UsageError(
            f'{before} {word}: a value and its unit are one word, {before}{word} or "{before} {word}"'
        )
