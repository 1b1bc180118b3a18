"""`compile`: a scene to a module of its own, for the user's repository."""

import keyword
import re
from collections.abc import Callable, Container, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from ...compiler.languages import language_of, languages
from ...compiler.languages.protocol import Module
from ...compiler.languages.shared import refuse_taken
from ...compiler.languages.words import words_of
from ...crankshaft.sums import SliderSums
from ...mechanism.keywords import with_known_keywords
from ...mechanism.own import using
from ...support.checks import yes_or_no
from ...support.files import as_path
from ...support.shown import printable
from ...support.written import Generated, sealed
from ..content import Content
from ..scene import Scene
from ..scene import scene as scene_of
from ..schema import SceneError
from .fmu.write import fmu_of
from .numba_module import numba_module_of
from .peaks import left_out_of_module
from .portable import Order, left_out, module_of
from .shaft import module_of_shaft, written_name

DEFAULT = "numba"


@with_known_keywords
def compile(
    scene: Scene | str | PathLike[str] | Mapping[str, Any],
    path: str | PathLike[str],
    to: str = "numba",
    *,
    check: bool = False,
    overwrite: bool = False,
    input: str = "torque",
) -> Path:
    """Write the outputs of a scene as source code of its own, which needs nothing of desaxe.

    Numbers in the scene are folded in; its lists and ranges become arguments, in the order theta,
    ec, AB, BC, omega0 (or omega), alpha, then masses and loads. `to` is the language:

    numba       FILE.py, which needs NumPy and numba: `point(...)`, `evaluate(...)`, `run()`, which takes
                other axes, too, and for each output a function to call from an @njit of your own; for each
                [[peak]] of designs that turn fully, without friction, a function such as `peak_absmax_a_C()`
    c           C99: FOLDER/name.h and name.c, where `name` is the folder's: `int name_point(in, out)`,
                `void name_array(n, in, out)`, `name_inverse`, `name_limits`; where masses are given
                `name_alpha` and `name_step`, the motion under a torque in steps of order 4
    octave      name.m for GNU Octave and MATLAB: `[a_C, V_C] = name(theta, ec)`
    jax         a module with a function for each output and `evaluate(**inputs)`; its derivatives are the
                derived ones
    javascript  an ES module and its types
    fmu         FILE.fmu, a Functional Mock-up Unit of FMI 2.0 (extra `fmu`): model exchange and
                co-simulation. A torque moves the crank; `input="omega"`: its speed is given

    A path with the suffix of the language is the file; any other is a folder, whose last part is the
    name. The same scene gives the same bytes.
    `check=True` writes nothing and raises ValueError if the files are not up to date. A file
    that desaxe did not write, or that was edited since, is left unchanged, and FileExistsError raised, unless
    `overwrite` is true.

    Returns the path. Raises as `scene` does, SceneError if the scene requests no outputs, and ValueError
    for an unknown language or an invalid name.

        dx.compile("examples/compactor.toml", "my_kernels.py")
        dx.compile("examples/compactor.toml", "press", to="c")

    See docs/choose.md: which call for which question.
    """
    place = as_path("path", path)
    yes_or_no(check=check, overwrite=overwrite)
    made = generated(scene if isinstance(scene, Scene) else scene_of(scene), place, to, input)
    return write_or_check(made, place, check, overwrite)


def those_with(has: str) -> str:
    """The languages that have something, listed."""
    names = (one.name for one in languages() if getattr(one, has))
    return " and ".join(", ".join(names).rsplit(", ", 1))


def require_fmu(place: Path) -> None:
    """ValueError for the place of an FMU that is not NAME.fmu."""
    if place.suffix != ".fmu":
        raise ValueError(f"{printable(place)}: the file of an FMU is called NAME.fmu")
    require_name(place.stem, place, words_of("c").modules)


def generated(scene: Scene, place: Path, to: str = "numba", drive: str = "torque") -> Generated:
    """The files of a scene in a language; nothing is written."""
    with using(scene.content.definitions):
        if isinstance(to, str) and to == "fmu":
            require_fmu(place)
            return fmu_of(scene, place, drive)
        return _generated(scene, place, to)


def _generated(scene: Scene, place: Path, to: str) -> Generated:
    language = language_of(to, "fmu")
    if scene.content.accuracy == "extended" and not language.extended:
        raise SceneError(f'accuracy = "extended": {to} has standard, {those_with("extended")} have both')
    make = numba_module_of if to == "numba" else module_of
    source = Path(scene.name).name
    return _files(place, to, scene.content.outputs, source, "desaxe.compile(scene, ", partial(make, scene))


def generated_of_shaft(
    sliders: SliderSums,
    speeds: Mapping[str, Any],
    outputs: Sequence[str],
    place: Path,
    to: str,
    source: str = "",
) -> Generated:
    """The files of quantities of a crankshaft in a language; nothing is written."""
    if to == "fmu":
        raise ValueError('to = "fmu": an FMU is of one slider; compile the crankshaft to another language')
    make = partial(module_of_shaft, sliders, speeds, outputs)
    return _files(place, to, [*map(written_name, outputs)], source, "crankshaft.compile(", make)


def _files(
    place: Path, to: str, outputs: Sequence[str], source: str, call: str, make: Callable[[Order], Module]
) -> Generated:
    """The files of a module of these outputs; `source` is its file, else a `call` made it."""
    language, words = language_of(to, "fmu"), words_of(to)
    refuse_taken(outputs, words.outputs)
    is_file = place.suffix == language.suffix
    name = place.stem if is_file else place.name
    if language.only_file:
        _require_importable(place, words.modules)
    else:
        require_name(name, place, words.modules)
    folder = place.parent if is_file else place
    option, keyword = (f" --to {to}", f', to="{to}"') if to != DEFAULT else ("", "")
    said = f"desaxe compile {source}{option} -o {place.name}"
    if not source:
        said = f'{call}"{place.name}"{keyword})'
    module = make(Order(to, name, said, language.second_order, language.steps))
    return Generated(folder, {file: sealed(text) for file, text in language.files(module).items()})


def write_or_check(made: Generated, place: Path, check: bool, overwrite: bool) -> Path:
    """Write files, or with `check` raise ValueError where others are there; the path."""
    yes_or_no(check=check, overwrite=overwrite)
    if not check:
        made.write(overwrite)
    elif stale := made.stale():
        names = ", ".join(Path(name).name for name in stale)
        raise ValueError(f"{printable(place)}: not what the scene gives ({names}); write it again")
    return place


def lost_of(content: Content, to: str) -> list[str]:
    """The parts of a scene that its module in a language leaves out, by name."""
    return left_out_of_module(content) if to == "numba" else left_out(content)


def require_name(name: str, place: Path, words: Container[str]) -> None:
    """ValueError for a module name that is not valid in every language, or a word of this one."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or _is_word(name, words):
        word = re.sub(r"\W", "_", name, flags=re.ASCII)
        good = word if re.match(r"[A-Za-z]", word) and not _is_word(word, words) else f"press_{word}"
        raise ValueError(
            f"{printable(place)}: {name!r} cannot be the name of a module, but {good!r}, for example"
        )


def _require_importable(place: Path, words: Container[str]) -> None:
    """ValueError for a file name that Python cannot import."""
    name = place.stem
    if place.suffix != ".py" or not name.isidentifier() or _is_word(name, words):
        word = re.sub(r"\W", "_", name)
        good = word if word.isidentifier() and not _is_word(word, words) else f"kernels_{word}"
        raise ValueError(
            f"{printable(place)}: Python cannot import a module of this name, but {good}.py, for example"
        )


def _is_word(name: str, words: Container[str]) -> bool:
    return keyword.iskeyword(name) or name in words
