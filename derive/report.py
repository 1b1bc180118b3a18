"""`python -m derive --report`: seconds and sizes of each module, operations of each quantity by pass."""

from collections.abc import Mapping
from time import perf_counter

from desaxe.compiler.languages.numba.library import emit_folder
from desaxe.compiler.passes.pipeline import PASSES, optimise_in_steps
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.passes.trigonometry import expand_trigonometry
from desaxe.support.text_table import table

from .build import Derivation
from .groups import GROUPS
from .quantities import QUANTITIES
from .write import module_of

GENERAL = {"branch": 1.0}
CONCENTRIC = {"branch": 1.0, "ec": 0.0, "alpha": 0.0}


def report(derivation: Derivation) -> str:
    """The modules; operations of each quantity after each pass, in general and for a concentric crank."""
    whole, frozen = len(derivation.program.lines), len(derivation.frozen.lines)
    parts = [f"as frozen {frozen} operations; same values merged {whole}, for {len(derivation.names)} names"]
    titles = ["module", "seconds", "lines", "results", "operations", "with wide margins"]
    parts.append("\nmodules:\n" + _table(titles, _modules(derivation)))
    for title, fixed in (("branch = 1", GENERAL), ("branch = 1, ec = 0, alpha = 0", CONCENTRIC)):
        rows = [_row(derivation, name, fixed) for name in QUANTITIES]
        steps = ["sliced", *PASSES]
        titles = ["quantity", *steps, "sin, cos written out", "with its sensitivities"]
        parts.append(f"\noperations with {title}:\n" + _table(titles, rows))
    return "\n".join(parts)


def _modules(derivation: Derivation) -> list[list[object]]:
    """A row for each module: the seconds of its lines, and sizes."""
    modules, seconds = {}, {}
    for group in GROUPS:
        start = perf_counter()
        modules[group.name] = module_of(derivation, group, "")
        emit_folder({group.name: modules[group.name]}, "", derivation.trigonometry)
        seconds[group.name] = f"{perf_counter() - start:.2f}"
    texts = emit_folder(modules, "", derivation.trigonometry)
    rows: list[list[object]] = []
    for name, (module, _) in modules.items():
        programs = module.forms.stable, module.forms.plain or module.forms.stable
        size, sizes = len(texts[name].splitlines()), [len(program.lines) for program in programs]
        rows.append([name, seconds[name], size, len(module.outputs), *sizes])
    return rows


def _row(derivation: Derivation, name: str, fixed: Mapping[str, float]) -> list[object]:
    program, steps = optimise_in_steps(keep_outputs(derivation.program, (name,)), fixed)
    family = tuple(n for n in derivation.names if n == name or n.startswith(f"{name}_wrt_"))
    wide, _ = optimise_in_steps(keep_outputs(derivation.program, family), fixed)
    written_out = expand_trigonometry(program, derivation.trigonometry)
    return [name, *(count for _, count in steps), len(written_out.lines), len(wide.lines)]


def _table(titles: list[str], rows: list[list[object]]) -> str:
    return "\n".join(table([titles, *([str(cell) for cell in row] for row in rows)]))
