"""Would a wrong ledger be noticed? Random changes of its entries, each held against the proofs.

    python -m tests.papers.mutate --seed 1 --number 2000 --no-hashes --no-table

changes signs, numbers, verdicts, whole corrections and evidences, places, names of tests and words, and
deletes entries, one at a time; then it counts by kind what the checks of the tests notice, and shows what
they do not. Without hashes and table only the proofs are left, which cannot know words.
"""

import argparse
import random
import re
from collections.abc import Callable

from tests.papers.entry_checks import complaints, raw_entries
from tests.papers.errata.ledger import VERDICTS
from tests.papers.frozen import frozen, row_of
from tests.papers.proofs import all_proofs

Entry = dict[str, str]
TEXTS = ("printed", "corrected", "evidence")
SIGN = re.compile(r"(?<![A-Za-z])[-+](?=[\w(|.])|(?<= )[-+](?= )")
DIGIT = re.compile(r"\d")
WORD = re.compile(r"(?<![\w{])[A-Za-z]{3,}(?![\w|=])")


def change_at(
    rng: random.Random,
    entry: Entry,
    pattern: re.Pattern[str],
    fields: tuple[str, ...],
    new: Callable[[str], str],
) -> Entry | None:
    """The entry with one match of a pattern in one of its fields replaced; None where there is none."""
    places = [(field, result) for field in fields for result in pattern.finditer(entry[field])]
    if not places:
        return None
    field, result = rng.choice(places)
    text = entry[field]
    return {**entry, field: text[: result.start()] + new(result.group()) + text[result.end() :]}


def sign(rng: random.Random, entry: Entry) -> Entry | None:
    """A plus for a minus, or the other way round."""
    return change_at(rng, entry, SIGN, TEXTS, lambda old: "+" if old == "-" else "-")


def number(rng: random.Random, entry: Entry) -> Entry | None:
    """Another digit."""
    return change_at(rng, entry, DIGIT, TEXTS, lambda old: rng.choice("0123456789".replace(old, "")))


def verdict(rng: random.Random, entry: Entry) -> Entry:
    """Another verdict."""
    return {**entry, "verdict": rng.choice([other for other in VERDICTS if other != entry["verdict"]])}


def whole(field: str) -> Callable[[random.Random, Entry], Entry | None]:
    """A change that gives an entry the correction or the evidence of another one of its paper."""

    def change(rng: random.Random, entry: Entry) -> Entry | None:
        others = [e[field] for e in raw_entries().values() if e["document"] == entry["document"]]
        new = rng.choice([text for text in others if text != entry[field]])
        return {**entry, field: new} if entry[field] else None

    return change


def where(rng: random.Random, entry: Entry) -> Entry | None:
    """Another place in the paper."""
    return change_at(rng, entry, DIGIT, ("where",), lambda old: rng.choice("123456789".replace(old, "")))


def test(rng: random.Random, entry: Entry) -> Entry:
    """Another proof."""
    others = [other["test"] for other in raw_entries().values() if other["test"] != entry["test"]]
    return {**entry, "test": rng.choice(others)}


def word(rng: random.Random, entry: Entry) -> Entry | None:
    """A word left out."""
    return change_at(rng, entry, WORD, TEXTS, lambda old: "")


KINDS = {
    "sign": sign,
    "number": number,
    "verdict": verdict,
    "corrected": whole("corrected"),
    "evidence": whole("evidence"),
    "where": where,
    "test": test,
    "word": word,
    "deleted": lambda rng, entry: {},
}


def noticed(key: str, entry: Entry, hashes: bool, table: bool) -> list[str]:
    """Complaints of the checks about a changed entry, or its absence."""
    kept = frozen()[key]
    if not entry:
        return [f"{key} is proved and has no entry"]
    wrong = complaints(entry, all_proofs()[key])
    now = row_of(entry)
    wrong += ["verdict of the frozen table"] if table and now[0] != kept[0] else []
    return wrong + (["hash"] if hashes and now[1:] != kept[1:] else [])


def survivors(
    seed: int, count: int, hashes: bool, table: bool, kinds: list[str], among: int | None = None
) -> tuple[dict, list]:
    """Changes of `among` entries made and noticed, by kind, and those not noticed."""
    rng, rows = random.Random(seed), raw_entries()
    keys = list(rows) if among is None else rng.sample(list(rows), among)
    counts, missed = {kind: [0, 0] for kind in kinds}, []
    while sum(made for made, _ in counts.values()) < count:
        kind, key = rng.choice(kinds), rng.choice(keys)
        entry = KINDS[kind](rng, rows[key])
        if entry is None:
            continue
        seen = bool(noticed(key, entry, hashes, table))
        counts[kind][0] += 1
        counts[kind][1] += seen
        if not seen:
            missed.append((kind, key, rows[key], entry))
    return counts, missed


def difference(old: Entry, new: Entry) -> str:
    """The field that was changed, before and after."""
    field = next(name for name in old if old[name] != new[name])
    return f"{field}: {old[field]!r}\n        -> {new[field]!r}"


def main() -> None:
    """Make the changes and report."""
    parser = argparse.ArgumentParser(prog="python -m tests.papers.mutate", description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--number", type=int, default=1000, help="changes to try")
    parser.add_argument("--kinds", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--no-hashes", action="store_true", help="leave the hashes of the texts out")
    parser.add_argument("--no-table", action="store_true", help="leave the frozen verdicts out")
    options = parser.parse_args()
    counts, missed = survivors(
        options.seed, options.number, not options.no_hashes, not options.no_table, options.kinds
    )
    for kind, key, old, new in missed:
        print(f"{kind:9} {key}: {difference(old, new)}")
    for kind, (made, seen) in counts.items():
        print(f"{kind:9} {seen:5} of {made:5} noticed, {100 * seen / max(made, 1):5.1f} %")


if __name__ == "__main__":
    main()
