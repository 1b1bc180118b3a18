"""The Program of a request: sliced to its outputs, with the fixed inputs folded in, after all passes."""

from functools import lru_cache

from ..compiler.passes.pipeline import optimise
from ..compiler.passes.slicing import keep_outputs
from ..compiler.program import Line, Program, names_in, renamed
from ..mechanism.load_lines import Under
from ..mechanism.own import used_by
from ..mechanism.program import Variant, program_of
from ..support.forks import IMPORTS

# What an output may lose when inputs are fixed -> the line that is 0 where there is such a thing, else NaN.
KEPT = {"D": "no_effect_on_rod", "omega2_law": "not_stalled"}


def specialise(
    names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...], accuracy: str = "standard"
) -> Program:
    """The program of these names with some inputs fixed, after all passes; its outputs stand in their order.

    A value that loses what it depended on (V_C by alpha for a given state, the torque of a massless
    rod) is still NaN where the mechanism cannot be assembled, or has stalled. A name of a user's own
    is the one that the form has, or as it is defined now. Accuracy: standard or extended.
    """
    return _specialise(names, form if form.own else form._replace(own=used_by(names)), fixed, accuracy)


@lru_cache(maxsize=1024)
def _specialise(
    names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...], accuracy: str
) -> Program:
    if form.under is not None:
        return _under_loads(names, form.under, form._replace(under=None), fixed, accuracy)
    program = _with_extended_forms(program_of(names, form), accuracy)
    result = optimise(program, dict(fixed))
    before, after = _needs(program), _needs(result)
    kept = {"D"} if dict(fixed).get("alpha") == 0.0 else set(KEPT)  # a crank at constant speed never stalls
    outputs = program.outputs
    whole_numbers = {line.name for line in program.lines if line.type == "i64"}  # a status cannot be NaN
    lost = {name: (before[name] & kept) - after[name] for name in outputs if name not in whole_numbers}
    if not any(lost.values()):
        return result
    wide = _with_extended_forms(program_of((*names, *KEPT.values()), form), accuracy)
    wide = renamed(wide, {name: f"{name}_alone" for name in outputs if lost.get(name)})
    lines = list(wide.lines)
    for name in outputs:
        value = f"{name}_alone"
        for need in sorted(lost.get(name, ())):
            lines.append(Line(f"{value}_{need}", "add", (value, KEPT[need])))
            value = lines[-1].name
        if lost.get(name):
            lines.append(Line(name, "copy", (value,)))
    whole = keep_outputs(wide._replace(lines=tuple(lines)), outputs)
    return optimise(whole, dict(fixed))


def _under_loads(
    names: tuple[str, ...],
    under: Under,
    form: Variant,
    fixed: tuple[tuple[str, float], ...],
    accuracy: str,
) -> Program:
    """The program of the totals under loads, and of the names that follow theirs."""
    others = names[len(under.totals) :]
    own = [name for _, name in under.names]
    needed = tuple(dict.fromkeys((*own, *others)))
    program = _specialise(needed, form, fixed, accuracy)
    outputs = dict(zip(needed, program.outputs, strict=True))
    every = program._replace(outputs=tuple(outputs[name] for name in (*own, *needed)))
    return under.added_to(every, dict(fixed), [outputs[name] for name in others])


@lru_cache(maxsize=1024)
def plain_form(
    names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...], accuracy: str = "standard"
) -> Program | None:
    """The program in plain forms, for designs with wide margins; None where it equals the stable program."""
    plain = specialise(names, form._replace(wide_margins=True), fixed, accuracy)
    stable = specialise(names, form, fixed, accuracy)
    same = repr(plain.lines) == repr(stable.lines)  # by their text: NaN is NaN there
    return None if same else plain


def _with_extended_forms(program: Program, accuracy: str) -> Program:
    if accuracy != "extended":
        return program
    with IMPORTS:
        from ..compiler.passes.double_double import with_extended_only_forms

    return with_extended_only_forms(program)


def _needs(program: Program) -> dict[str, frozenset[str]]:
    """Map each line to the names of KEPT that it depends on."""
    needs: dict[str, frozenset[str]] = dict.fromkeys(program.inputs, frozenset())
    for line in program.lines:
        own = frozenset({line.name} & set(KEPT))
        needs[line.name] = own.union(*(needs[name] for name in names_in(line.args)))
    return needs
