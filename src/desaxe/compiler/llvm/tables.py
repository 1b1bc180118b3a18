"""Tables in vectors: elements and rows that are loaded point by point, which takes less than a gather."""

from collections.abc import Sequence
from pathlib import Path

TEXT = Path(__file__).with_name("tables.ll").read_text()


def tables_text(lanes: int) -> str:
    """The functions that look tables up, at one point and at as many as a vector has."""
    return "\n\n".join([TEXT.replace("LANES", str(lanes)), _elements(lanes), _rows(lanes)])


def _elements(lanes: int) -> str:
    """The function `elements(array, indices)`."""
    kind, value = f"<{lanes} x double>", "poison"
    lines = []
    for k in range(lanes):
        lines += [
            f"  %i{k} = extractelement <{lanes} x i64> %index, i64 {k}",
            f"  %p{k} = getelementptr double, ptr %array, i64 %i{k}",
            f"  %x{k} = load double, ptr %p{k}",
            f"  %v{k} = insertelement {kind} {value}, double %x{k}, i64 {k}",
        ]
        value = f"%v{k}"
    head = f"define internal {kind} @elements(ptr %array, <{lanes} x i64> %index) noinline {{"
    return "\n".join([head, *lines, f"  ret {kind} {value}", "}"])


def _rows(lanes: int) -> str:
    """The function `coefficients(rows, numbers)`: four of each point, from rows of four side by side."""
    kind, lines = f"<{lanes} x double>", []
    for k in range(lanes):
        lines += [
            f"  %i{k} = extractelement <{lanes} x i64> %number, i64 {k}",
            f"  %p{k} = getelementptr [4 x double], ptr %rows, i64 %i{k}",
            f"  %r{k} = load <4 x double>, ptr %p{k}, align 8",
        ]

    def mixed(name: str, pair: Sequence[str], order: str, width: int = 4) -> str:
        mask = ", ".join(f"i32 {place}" for place in order.split())
        one, other = (f"<{width} x double> {value}" for value in pair)
        lines.append(f"  {name} = shufflevector {one}, {other}, <{len(order.split())} x i32> <{mask}>")
        return name

    parts = []
    for first in range(0, lanes, 4):
        pairs = [(f"%r{k}", f"%r{k + 1}") for k in (first, first + 2)]
        even = [mixed(f"%e{first}.{k}", pair, "0 4 2 6") for k, pair in enumerate(pairs)]
        odd = [mixed(f"%o{first}.{k}", pair, "1 5 3 7") for k, pair in enumerate(pairs)]
        orders = ((even, "0 1 4 5"), (odd, "0 1 4 5"), (even, "2 3 6 7"), (odd, "2 3 6 7"))
        parts.append([mixed(f"%c{first}.{k}", *both) for k, both in enumerate(orders)])
    whole_vectors = parts[0]
    if len(parts) == 2:
        every = " ".join(map(str, range(8)))
        whole_vectors = [mixed(f"%w{k}", pair, every) for k, pair in enumerate(zip(*parts, strict=True))]
    result, whole = "poison", f"{{ {', '.join([kind] * 4)} }}"
    for k, part in enumerate(whole_vectors):
        lines.append(f"  %s{k} = insertvalue {whole} {result}, {kind} {part}, {k}")
        result = f"%s{k}"
    head = f"define internal {whole} @coefficients(ptr %rows, <{lanes} x i64> %number) noinline {{"
    return "\n".join([head, *lines, f"  ret {whole} {result}", "}"])
