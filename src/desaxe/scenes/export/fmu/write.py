"""The archive of an FMU: the same scene gives the same bytes; the binary is that of the compiler at hand."""

import hashlib
import platform
import shutil
import subprocess
import tempfile
import warnings
import zipfile
from io import BytesIO
from pathlib import Path

from ....loads.resolve import split
from ....support.extras import needed
from ....support.shown import printable
from ....support.version import version
from ....support.written import Generated, require_path, sealed, write_whole
from ...content import Content
from ...scene import Scene
from ...schema import SceneError
from ..loaded import require_tables
from ..motion import has_masses
from ..portable import heading, require_outputs
from .description import description
from .programs import programs
from .source import source_text
from .variables import variables

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")
# Folder and suffix of a binary on a system and processor; FMI 2.0 names no others.
FOLDERS = {
    ("Linux", "x86_64"): ("linux64", ".so"),
    ("Darwin", "x86_64"): ("darwin64", ".dylib"),
    ("Darwin", "arm64"): ("darwin64", ".dylib"),
}


class FmuWarning(UserWarning):
    """An FMU without a binary."""


class Archive(Generated):
    """The texts in an FMU; written, with a binary beside them where a C compiler is."""

    def there(self, name: str) -> bytes | None:
        """The content of a file in the archive; None where there is none."""
        if not zipfile.is_zipfile(self.folder):
            return None
        with zipfile.ZipFile(self.folder) as archive:
            return archive.read(name) if name in archive.namelist() else None

    def write(self, overwrite: bool) -> None:
        """Write the archive; with a warning, and without a binary, where no C compiler is."""
        require_path(self.folder, overwrite)
        contents = {name: text.encode() for name, text in self.texts.items() if text}
        result = binary_of(contents[f"sources/{self.folder.stem}.c"], self.folder.stem)
        if isinstance(result, str):
            why = "an FMU of sources alone, which the importing program compiles"
            message = f"{printable(self.folder)}: {result}: {why}"
            warnings.warn(message, FmuWarning, stacklevel=3)
        else:
            contents |= dict([result])
        with write_whole(self.folder, overwrite) as staged:
            staged.write_bytes(_zipped(contents))

    def summary(self) -> list[str]:
        """The names in the archive, in a line."""
        with zipfile.ZipFile(self.folder) as archive:
            return [f"{self.folder}: FMI 2.0, {', '.join(archive.namelist())}"]


def fmu_of(scene: Scene, place: Path, drive: str = "torque") -> Archive:
    """The FMU of a scene; nothing is written."""
    return Archive(place, texts_of_fmu(scene, place, drive))


def texts_of_fmu(scene: Scene, place: Path, drive: str = "torque") -> dict[str, str]:
    """The texts in an FMU by name."""
    _check(scene, drive)
    content, name = scene.content, place.stem
    table = variables(content, drive)
    made = programs(content, table)
    source = Path(scene.name).name
    options = f" --input {drive}" * (drive != "torque")
    said = f"desaxe compile {source or 'SCENE'} --to fmu -o {place.name}{options}"
    head = [*heading(scene, said), "", *_facts(content, drive)]
    # The token is that of all texts, which have every number of the machine and of its tables.
    digest = hashlib.sha256((repr(table) + source_text(head, table, made, "")).encode()).hexdigest()
    token = f"{{{'-'.join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32]))}}}"
    about = {
        "modelName": name,
        "description": scene.title or "An offset slider-crank",
        "generationTool": f"desaxe {version()}",
    }
    return {
        "modelDescription.xml": description(name, about, table, made, token),
        f"sources/{name}.c": sealed(source_text(head, table, made, token)),
    }


def _check(scene: Scene, drive: str) -> None:
    """An error for what an FMU cannot carry, by name."""
    where = scene.name or "scene"
    if drive not in ("torque", "omega"):
        raise ValueError(f"input = {drive!r}: it is torque or omega")
    require_outputs(scene)
    content = scene.content
    if content.accuracy == "extended":
        raise SceneError(f'{where}: accuracy = "extended": an FMU has standard')
    require_tables(where, split(content.inputs)[1], fmu=True)
    if drive == "torque" and not has_masses(content.inputs):
        raise SceneError(
            f"{where}: nothing moves under a torque without inertia: give [masses], or --input omega"
        )


def _facts(content: Content, drive: str) -> list[str]:
    return [
        "SI units and radians. Y points along the slider axis towards the slider,",
        f"theta turns from +Y towards +X; branch {content.branch:+d}; the input is {drive}.",
        *(f"{name} is the input and {load.told()}." for name, load in split(content.inputs)[1].items()),
        "A result that has no value is NaN.",
    ]


def _zipped(contents: dict[str, bytes]) -> bytes:
    """The archive, without the time of its making."""
    whole = BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in contents.items():
            archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
    return whole.getvalue()


def headers() -> Path:
    """The folder of the standard's header files, which an importer brings, as fmpy does."""
    with needed("desaxe compile --to fmu", "fmu"):
        import fmpy
    return Path(fmpy.__file__).parent / "c-code"


def binary_of(source: bytes, name: str) -> tuple[str, bytes] | str:
    """The name in the archive and the bytes of the library; else why there is none."""
    system, machine = platform.system(), platform.machine()
    compiler = next((path for path in map(shutil.which, COMPILERS) if path is not None), None)
    if (system, machine) not in FOLDERS:
        return f"FMI 2.0 has no binary that is built here, on {system} ({machine})"
    if compiler is None:
        return f"no C compiler found ({', '.join(COMPILERS)})"
    folder, suffix = FOLDERS[system, machine]
    with tempfile.TemporaryDirectory() as place:
        file, made = Path(place) / f"{name}.c", Path(place) / f"{name}{suffix}"
        file.write_bytes(source)
        command = [compiler, *FLAGS, f"-I{headers()}", str(file), "-o", str(made), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(f"{compiler} cannot compile the FMU: {done.stderr[:500]}")
        return f"binaries/{folder}/{name}{suffix}", made.read_bytes()
