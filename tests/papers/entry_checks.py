"""An entry of the ledgers held against its proof: the verdict, every number, sign, formula and reference.

In `corrected` and `evidence` a digit or a sign stands only in a mark (`{name|6816}`, `{= v_s = -V_C}`), in a
name of the paper, or in a reference (Eq. 4, Sec. 3.1, an entry's id), which the proof lists in `cites`.
Numbers of `printed` are those of the proof, which has them from the paper. So what no proof knows cannot
stand in an entry unseen.
"""

import re
from functools import cache

from mpmath import mp, mpf

from tests.papers import formulas, letters
from tests.papers.digits import DIGITS
from tests.papers.errata import ledger
from tests.papers.errata.equations import FINE
from tests.papers.errata.marks import MARK
from tests.papers.proofs import PROOFS, Proof

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?(?: million)?(?![\w.]*\d)")
NAME = re.compile(r"[A-Za-z][\w/]*\d\w*")
ENTRY = re.compile(r"\b[ABC]-[A-Za-z0-9][\w.-]*\w")
REFERENCE = re.compile(r"\b[ABC]-[A-Za-z0-9][\w.-]*\w|(?<![\w.])\d+(?:\.\d+)*[a-z]?")
SIGN = re.compile(r"(?<![\w)\]])[-+](?=[\w(.])|(?<= )[-+](?= )")
NUMBERED = re.compile(r"[AB]-(eq|listing)")
OPPOSITE = {
    "sign": r"[-+\s]",
    "sign and exponent": r"[-+\s]|\^\(\d/2\)",
    "sign and missing factor": r"[-+\s]|e\*",
}


@cache
def raw_entries() -> dict[str, dict[str, str]]:
    """The entries as they stand in the files, with their marks, by id."""
    return {row["id"]: row for sheet in ledger.sheets().values() for row in sheet["entry"]}


def complaints(row: dict[str, str], proof: Proof) -> list[str]:
    """Differences between an entry and its proof."""
    result = proof.found()
    wrong = copied(row, proof) + unshown(row, proof, result)
    wrong += (
        [] if row["verdict"] == proof.verdict else [f"verdict {row['verdict']!r}, proved {proof.verdict!r}"]
    )
    if row["test"] != proof.node:
        wrong.append(f"test {row['test']}, proved by {proof.node}")
    if bool(row["corrected"]) == (proof.verdict in FINE):
        wrong.append("a correction where nothing is wrong, or none")
    with mp.workdps(DIGITS):
        wrong += printed(row, proof, result) + corrected(row, proof, result)
        wrong += marked(row["id"], row["evidence"], result)
    coded = proof.instead or (is_formula(row["id"]) and not MARK.search(row["corrected"]))
    prose = row["evidence"] if coded else f"{row['corrected']} {row['evidence']}"
    return wrong + loose(row["id"], prose, proof.cites)


def copied(row: dict[str, str], proof: Proof) -> list[str]:
    """Texts that are those of an entry of another test, or of another numbered equation."""
    others = [
        raw_entries()[key]
        for key, other in PROOFS.items()
        if key in raw_entries() and key != row["id"]
        if other.name != proof.name or NUMBERED.match(key)
    ]
    fields = ("corrected", "evidence")
    return [
        f"{field} of {o['id']}" for field in fields for o in others if row[field] and row[field] == o[field]
    ]


def unshown(row: dict[str, str], proof: Proof, result: dict) -> list[str]:
    """Numbers of the proof that no entry of its test shows."""
    same = [
        raw_entries()[key] for key, other in PROOFS.items() if other.test is proof.test and key != row["id"]
    ]
    texts = "".join(one["corrected"] + one["evidence"] for one in (row, *same))
    shown = {name for name, _, _ in MARK.findall(texts)} | {"printed", "names"}
    return [f"{name} is proved and not shown" for name in result if name not in shown]


def is_formula(key: str) -> bool:
    """True if the entry is an equation, written as one."""
    return bool(formulas.FORMULA.fullmatch(key))


def printed(row: dict[str, str], proof: Proof, result: dict) -> list[str]:
    """Errors of the printed form: not the paper's, or not as right or wrong as the verdict says."""
    text, fine = row["printed"], proof.verdict in FINE
    if is_formula(row["id"]):
        miss = formulas.misses(row["id"], text, printed=True)
        equal = not formulas.misses(row["id"], text, printed=False)
        return [f"printed {miss}"] * bool(miss) + ["printed form is right"] * (equal and not fine)
    numbers, rest = NUMBER.findall(text), NUMBER.sub("", text)
    if NUMBER.sub("", proof.says).strip():  # words, or a line of code
        same = flat(text) == flat(proof.says)
    elif SIGN.search(rest) or set(NAME.findall(rest)) - letters.WORDS:
        return ["a formula in the printed text: the proof must say it whole"]
    else:
        same = not proof.says or numbers == proof.says.split()
    if not same:
        return [f"printed {text!r}, the paper has {proof.says!r}"]
    if "printed" not in result:
        return [f"printed numbers {numbers} are not the proof's"] if numbers and not proof.says else []
    true = result["printed"]
    agree = len(numbers) == len(true) and all(map(shows, numbers, true))
    return [] if agree == fine else [f"printed {numbers}, proved {true}"]


def corrected(row: dict[str, str], proof: Proof, result: dict) -> list[str]:
    """Errors of the corrected form."""
    text = row["corrected"]
    if proof.instead:
        return [] if flat(text) == flat(proof.instead) else [f"corrected {text!r}, run {proof.instead!r}"]
    if not is_formula(row["id"]) or MARK.search(text):
        return marked(row["id"], text, result)
    wrong = [formulas.misses(row["id"], text, printed=False)] if text else []
    kept = OPPOSITE.get(proof.verdict)
    if kept and re.sub(kept, "", text) != re.sub(kept, "", row["printed"]):
        wrong.append(f"more than {proof.verdict} changes")
    return list(filter(None, wrong))


def marked(key: str, text: str, result: dict) -> list[str]:
    """The marks of a text that do not show what the proof found."""
    return [
        f"{name or 'formula'}: {miss}"
        for name, kind, shown in MARK.findall(text)
        if (miss := misshown(key, name, kind, shown, result))
    ]


def misshown(key: str, name: str, kind: str, shown: str, result: dict) -> str:
    """The error of one mark; empty if it is right."""
    if name and name not in result:
        return "not in the proof"
    if kind == "=":
        return formulas.misses(
            key, shown, printed=False, names=result.get("names", {}), true=result.get(name)
        )
    true = result[name]
    if isinstance(true, str):
        return "" if shown.split() == true.split() else f"{shown!r} is {true!r}"
    true = list(true) if isinstance(true, (list, tuple)) else [true]
    if unknown := set(NAME.findall(NUMBER.sub("", shown))) - letters.known(key[0]):
        return f"unknown {', '.join(unknown)}"
    numbers = NUMBER.findall(shown)
    agree = (
        len(numbers) == len(true)
        and all(map(shows, numbers, true))
        and not SIGN.search(NUMBER.sub("", shown))
    )
    return "" if agree else f"{shown} is {', '.join(mp.nstr(t, 12) for t in true)}"


def shows(number: str, true: mpf) -> bool:
    """True if a number, such as -20.2, 5.62e7, 6,816 or 13.7 million, is this value rounded to its digits."""
    digits, _, exponent = number.removesuffix(" million").replace(",", "").partition("e")
    unit = mpf(10) ** (int(exponent or 0) + 6 * number.endswith("million"))
    half = unit * mpf(10) ** -len(digits.partition(".")[2]) / 2
    return abs(mpf(digits) * unit - true) <= half * (1 + mpf(10) ** -12)


def loose(key: str, text: str, cites: str) -> list[str]:
    """Digits and signs outside of marks: references other than the proof's, unknown names, loose signs."""
    rest = MARK.sub("_", text)
    wrong = (
        []
        if (cited := " ".join(REFERENCE.findall(rest))) == cites
        else [f"refers to {cited!r}, not {cites!r}"]
    )
    wrong += [f"no entry {name}" for name in ENTRY.findall(rest) if name not in raw_entries()]
    rest = ENTRY.sub("", rest)
    wrong += [f"unknown name {name}" for name in NAME.findall(rest) if name not in letters.known(key[0])]
    return wrong + [
        f"loose sign in {rest[max(at.start() - 9, 0) : at.end() + 9]!r}" for at in SIGN.finditer(rest)
    ]


def harm_complaints(row: dict) -> list[str]:
    """Differences between a warning and the proofs of its entries; a mark shows a number of any.

    `{says|1.08}` is a number that the paper prints. Other digits are those of the entries.
    """
    proofs, text = [PROOFS[key] for key in row["entries"]], f"{row['what']} {row['cost']}"
    wrong = []
    for name, kind, shown in MARK.findall(text):
        if name == "says":
            wrong += (
                []
                if any(shown in NUMBER.findall(proof.says) for proof in proofs)
                else [f"no paper has {shown}"]
            )
        elif all(misshown(proof.entry, name, kind, shown, proof.found()) for proof in proofs):
            wrong.append(f"{name}: no proof has {shown}")
    cited = [number for number in REFERENCE.findall(MARK.sub("_", text)) if number not in row["entries"]]
    wrong += [
        f"{number} is of no entry"
        for number in cited
        if not any(key.endswith(number) for key in row["entries"])
    ]
    return wrong + loose(row["entries"][0], text, " ".join(REFERENCE.findall(MARK.sub("_", text))))


def flat(text: str) -> str:
    """A text without its spaces."""
    return "".join(text.split())
