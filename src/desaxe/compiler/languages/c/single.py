"""C in single precision: the text in doubles, token by token, and the numbers that belong to the format.

A Program of single precision has rounded what it folds; here a number becomes the nearest float, `double`
becomes `float`, and a function of libm its float twin. Comments and strings stay as they are.
"""

import re
from sys import float_info

from ...interpret import to_single

LEAST, MOST, LARGEST = "1e-45f", "(float)INFINITY", "3.4028235e+38f"
FUNCTIONS = ("fabs", "sqrt", "sin", "cos", "atan2", "hypot", "exp", "log", "pow", "floor", "copysign")

# What helpers and steps say of doubles -> what holds for floats.
FORMAT = {
    # error-free products, bounds of rounding, powers of two: 53 bits -> 24
    "134217729.0": "4097.0f",
    "4.440892098500626e-16": "2.3841858e-07f",
    "9007199254740992.0": "16777216.0f",
    "1.0261342003245941e-289": "7.888609e-31f",  # 2^-100
    "9.7453140114e+288": "1.2676506e+30f",
    "1e-15": "1e-7f",  # of a step, to which its cut is sought
    # functions without libm: the bits of a number, whole numbers, scales
    "uint64_t": "uint32_t",
    "(double)(int64_t)a": "(double)(int32_t)a",
    "UINT64_C(0x8000000000000000)": "UINT32_C(0x80000000)",
    "UINT64_C(0x7ff8000000000000)": "UINT32_C(0x7fc00000)",
    "UINT64_C(0x7ff0000000000000)": "UINT32_C(0x7f800000)",
    "UINT64_C(0x1ff8000000000000)": "UINT32_C(0x1fc00000)",
    ">> 63": ">> 31",
    "4503599627370496.0": "8388608.0f",
    "1.7976931348623157e308": LARGEST,
    **{f"0x1p{old}": f"0x1p{new}f" for old, new in {
        "-500": "-60", "+512": "+64", "-256": "-32", "+500": "+60", "-512": "-64", "+256": "+32",
        "-960": "-100", "+960": "+100", "+100": "+60", "-100": "-60",
    }.items()},
    "1e-9": "1e-4f",  # below, an angle is its tangent
    # pi and its half in two words
    "1.5707963267948966": "1.5707964f", "6.123233995736766e-17": "-4.371139e-08f",
    "3.141592653589793": "3.1415927f", "1.2246467991473532e-16": "-8.742278e-08f",
}  # fmt: skip

_NUMBER = r"(?<![\w.])(?:\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])"
_TOKENS = re.compile(
    r"(?P<kept>/\*.*?\*/|\"(?:\\.|[^\"\\])*\")"
    rf"|(?P<number>{_NUMBER})|(?P<type>\bdouble\b)"
    rf"|(?P<function>\b(?:{'|'.join(FUNCTIONS)})\b(?=\()|(?<=#define )(?:{'|'.join(FUNCTIONS)})\b)",
    re.DOTALL,
)
_OF_FORMAT = re.compile(
    r"(?P<kept>/\*.*?\*/)|(?<![\w.])(?P<word>"
    + "|".join(sorted(map(re.escape, FORMAT), key=len, reverse=True))
    + r")(?![\w.])",
    re.DOTALL,
)


def of_format(text: str) -> str:
    """A helper's text with the numbers of single precision."""
    return _OF_FORMAT.sub(lambda match: match["kept"] or FORMAT[match["word"]], text)


def in_single(text: str) -> str:
    """C text in single precision."""
    return _TOKENS.sub(_spelled, text)


def _spelled(match: re.Match[str]) -> str:
    if match["kept"]:
        return match["kept"]
    if match["number"]:
        return _number(float(match["number"]))
    return "float" if match["type"] else f"{match['function']}f"


def _number(value: float) -> str:
    """The shortest text of the nearest float; what is not 0 stays so."""
    rounded = to_single(value)
    if value == float_info.max:  # a bound
        return LARGEST
    if rounded in (0.0, float("inf")):
        return "0.0f" if value == 0.0 else LEAST if rounded == 0.0 else MOST
    text = next(
        text for text in (f"{rounded:.{n}g}" for n in range(1, 10)) if to_single(float(text)) == rounded
    )
    return f"{text}f" if "." in text or "e" in text else f"{text}.0f"
