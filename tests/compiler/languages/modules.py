"""A module of one Program, for any language."""

import mpmath

from desaxe.compiler.languages.protocol import Forms, Module, Symbol
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.passes.trigonometry import Trigonometry
from desaxe.compiler.program import Line
from desaxe.generated.trigonometry import CONSTANTS
from tests.compiler.coverage_set import NAMES, coverage
from tests.compiler.programs import exactly


def module(program, name="made"):
    """All outputs of the program as results; its status is 0, and nothing has a derivative."""
    inputs = tuple(Symbol(name, "1", "an argument") for name in program.inputs)
    outputs = tuple(Symbol(name, "1", "a result") for name in program.outputs)
    status = Line("zero_status", "copy", (0,), "i64")
    whole = program._replace(lines=(*program.lines, status), outputs=(*program.outputs, "zero_status"))
    forms = Forms(len(program.outputs), whole)
    values = {output: keep_outputs(program, [output]) for output in program.outputs}
    return Module(
        name, ("A test */ of ?? comments.\\", '"""'), inputs, outputs, forms, Trigonometry(**CONSTANTS),
        {output: {} for output in values}, values,
    )  # fmt: skip


def written(language, program, folder, *options):
    """The main file of a module, or of a program's; it is written with the others into a folder."""
    made = program if isinstance(program, Module) else module(program)
    for file, text in language.files(made, *options).items():
        (folder / file).write_text(text, encoding="utf-8")
    return folder / f"{made.name}{language.suffix}"


def wrong_names(answers, point, ulps=2.0):
    """The names of the coverage set that are not what the exact interpretation says."""
    with mpmath.workdps(30):
        expected = exactly(coverage(), point)
        x, y = map(mpmath.mpf, (point["x"], point["y"]))
        expected["lost"] += (x + y - mpmath.mpf(point["x"] + point["y"])) / 2
        size = max(1, *map(abs, point.values()))
        bound = ulps * 2.0**-52
        return [
            n
            for n in NAMES
            if n in answers and abs(answers[n] - expected[n]) > bound * max(size, abs(expected[n]))
        ]
