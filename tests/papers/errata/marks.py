"""The marks in a ledger's text, and what a correction changes.

`{peak|6816}` shows 6816, the number that the entry's proof returns as `peak`; `{= v_s = -V_C}` shows a
formula whose sides are equal, `{top= AB*omega^2*tan(phi)}` one that equals what the proof returns as `top`.
The tests compare them; readers see the text alone.
"""

import re
from collections.abc import Callable
from difflib import SequenceMatcher

MARK = re.compile(r"\{(\w*)([|=]) ?([^{}]*)\}")  # name, kind, what is shown

_TOKEN = re.compile(r"\w+|\s+|.")


def plain(text: str) -> str:
    """A text without the marks of its numbers and formulas."""
    return MARK.sub(r"\3", text)


def changes(old: str, new: str, shown: Callable[[str], str]) -> str:
    """The new text with what it changes in the old one as `shown` writes it.

    All behind the first "=" counts as changed where something is left out, or less than half is kept.
    """
    before, after = _TOKEN.findall(old), _TOKEN.findall(new)
    match = SequenceMatcher(None, before, after, autojunk=False)
    left_out = any(
        kind == "delete" and "".join(before[start:end]).strip()
        for kind, start, end, _, _ in match.get_opcodes()
    )
    if left_out or match.ratio() < 0.5:
        name, equals, value = new.partition("= ")
        return name + equals + shown(value) if equals else shown(new)
    parts = []
    for kind, _, _, start, end in match.get_opcodes():
        text = "".join(after[start:end])
        blank = "" if kind == "equal" or not text.strip() else text.strip()
        parts.append(text.replace(blank, shown(blank)) if blank else text)
    return "".join(parts)
