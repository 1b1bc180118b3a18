"""The archive of an FMU: the same scene gives the same bytes; the binary is that of the compiler at hand."""

import hashlib
import platform
import shutil
import subprocess
import sys
import tempfile
import warnings
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

from ....support.extras import needed
from ....support.generated import Generated
from ....support.shown import printable
from ....support.version import version
from ....support.written import require_path, sealed, write_whole
from ...content import Content
from ...scene import Scene
from ...schema import SceneError
from ..motion import has_masses
from ..portable import heading, require_outputs
from .description import build_description, description2, description3
from .loads import check_loads, tables
from .programs import programs
from .source import source_text
from .variables import variables

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")
SYSTEMS = {"Linux": ("linux", ".so"), "Darwin": ("darwin", ".dylib"), "Windows": ("windows", ".dll")}
MACHINES = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
FOLDERS_OF_2 = {
    ("linux", "x86_64"): "linux64",
    ("darwin", "x86_64"): "darwin64",
    ("windows", "x86_64"): "win64",
}


class FmuWarning(UserWarning):
    """An FMU without a binary."""


class Archive(Generated):
    """The texts in an FMU; written, with a binary beside them where a C compiler is."""

    def __init__(self, place: Path, texts: Mapping[str, str], fmi: int) -> None:
        super().__init__(place, texts)
        self.fmi = fmi

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
        found = binary_of(contents[f"sources/{self.folder.stem}.c"], self.folder.stem, self.fmi)
        if found is None:
            warnings.warn(
                f"{printable(self.folder)}: no C compiler found ({', '.join(COMPILERS)}): an FMU of sources "
                "alone, which the importing program compiles",
                FmuWarning,
                stacklevel=3,
            )
        else:
            contents |= dict([found])
        with write_whole(self.folder, overwrite) as staged:
            staged.write_bytes(_zipped(contents))

    def summary(self) -> list[str]:
        """The names in the archive, in a line."""
        with zipfile.ZipFile(self.folder) as archive:
            return [f"{self.folder}: FMI {self.fmi}.0, {', '.join(archive.namelist())}"]


def fmu_of(scene: Scene, place: Path, fmi: int = 3, drive: str = "torque") -> Archive:
    """The FMU of a scene; nothing is written."""
    return Archive(place, texts_of_fmu(scene, place, fmi, drive), fmi)


def texts_of_fmu(scene: Scene, place: Path, fmi: int = 3, drive: str = "torque") -> dict[str, str]:
    """The texts in an FMU by name."""
    _check(scene, fmi, drive)
    content, name = scene.content, place.stem
    table = variables(content, drive)
    made = programs(content, table)
    source = Path(scene.name).name
    options = f" --fmi {fmi}" * (fmi != 3) + f" --input {drive}" * (drive != "torque")
    said = f"desaxe compile {source or 'SCENE'} --to fmu -o {place.name}{options}"
    head = [*heading(scene, said), "", *_facts(content, drive)]
    token = hashlib.sha256(repr((head, fmi, drive, table)).encode()).hexdigest()
    token = f"{{{'-'.join((token[:8], token[8:12], token[12:16], token[16:20], token[20:32]))}}}"
    about = {
        "modelName": name,
        "description": scene.title or "An offset slider-crank",
        "generationTool": f"desaxe {version()}",
    }
    describe = description3 if fmi == 3 else description2
    found = {
        "modelDescription.xml": describe(name, about, table, made, token),
        f"sources/{name}.c": sealed(source_text(head, table, made, fmi, token)),
    }
    return found | ({"sources/buildDescription.xml": build_description(name)} if fmi == 3 else {})


def _check(scene: Scene, fmi: int, drive: str) -> None:
    """An error for what an FMU cannot carry, by name."""
    where = scene.name or "scene"
    if fmi not in (2, 3) or isinstance(fmi, bool):
        raise ValueError(f"fmi = {fmi!r}: it is 3 or 2")
    if drive not in ("torque", "omega"):
        raise ValueError(f"input = {drive!r}: it is torque or omega")
    require_outputs(scene)
    content = scene.content
    if content.accuracy == "extended":
        raise SceneError(f'{where}: accuracy = "extended": an FMU has standard')
    check_loads(where, content.outputs, tables(content.inputs))
    if drive == "torque" and not has_masses(content.inputs):
        raise SceneError(
            f"{where}: nothing moves under a torque without inertia: give [masses], or --input omega"
        )


def _facts(content: Content, drive: str) -> list[str]:
    return [
        "SI units and radians. Y points along the slider axis towards the slider,",
        f"theta turns from +Y towards +X; branch {content.branch:+d}; the input is {drive}.",
        *(f"{name} is the input and {load.told()}." for name, load in tables(content.inputs).items()),
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


def binary_of(source: bytes, name: str, fmi: int) -> tuple[str, bytes] | None:
    """The name in the archive and the bytes of the library; None where there is no compiler."""
    compiler = next((path for path in map(shutil.which, COMPILERS) if path is not None), None)
    system, suffix = SYSTEMS.get(platform.system(), ("", ""))
    machine = MACHINES.get(platform.machine(), "")
    folder = FOLDERS_OF_2.get((system, machine), "") if fmi == 2 else f"{machine}-{system}"
    if compiler is None or not system or not machine or not folder or sys.platform == "win32":
        return None
    with tempfile.TemporaryDirectory() as place:
        file, made = Path(place) / f"{name}.c", Path(place) / f"{name}{suffix}"
        file.write_bytes(source)
        command = [compiler, *FLAGS, f"-I{headers()}", str(file), "-o", str(made), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(f"{compiler} cannot compile the FMU: {done.stderr[:500]}")
        return f"binaries/{folder}/{name}{suffix}", made.read_bytes()
