"""The command `desaxe`: its sub-commands, and how errors reach the terminal.

Start-up is light: what a command needs is imported when it runs. A complaint is one line on stderr
with exit code 2.
"""

import errno
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from ..support.extras import MissingExtraError, explained
from ..support.interrupts import is_at_work
from ..support.shown import printable
from .calls import CALLS, call_commands
from .doctor import DOCTOR
from .files import FILES, derive
from .parser import parser_of
from .words import UsageError, options_first

LONGEST = 2_000  # characters of an error
INTERRUPTED, TERMINATED = 130, 143  # as a shell reports them


class Terminated(KeyboardInterrupt):
    """The process received SIGTERM: it stops as after Ctrl-C and leaves no half-written file."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code: 0 done, 1 a check failed, 2 an error in the input."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    _heed_termination()
    _occupy_descriptors()
    try:
        code = _run(words)
        if sys.stdout is None:
            raise OSError(errno.EBADF, "it is closed", "standard output")
        sys.stdout.flush()
        return code
    except SystemExit as done:  # --help
        return int(done.code or 0)
    except BrokenPipeError:  # whoever read our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt as stopped:
        ended = isinstance(stopped, Terminated)
        how = f"desaxe: {'terminated' if ended else 'interrupted'}"
        print(": ".join(map(str, (how, *stopped.args))), file=sys.stderr)
        return _leave(TERMINATED if ended else INTERRUPTED)
    except (UsageError, MissingExtraError, ValueError, TypeError, OSError, MemoryError) as error:
        print(f"desaxe: error: {_one_line(error)}", file=sys.stderr)
        return 2


def _occupy_descriptors() -> None:
    """Open the standard streams that whoever started us closed, lest a file take their place."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(descriptor)


def _heed_termination() -> None:
    """Turn SIGTERM, which would end the process at once, into an exception of the main thread."""

    def stop(number: int, frame: Any) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        raise Terminated

    with suppress(ValueError):  # not in the main thread
        signal.signal(signal.SIGTERM, stop)


def _leave(code: int) -> int:
    """Return the exit code, or end the process if a compiler is still running: Python would wait for it."""
    if is_at_work():
        if sys.stdout is not None:
            sys.stdout.flush()
        os._exit(code)
    return code


def _run(words: list[str]) -> int:
    if words[:1] == ["derive"]:  # its options are its own
        return derive(words[1:])
    if words and words[0] in CALLS:
        words = [words[0], *options_first(words[1:])]
    parser = parser_of((*call_commands(), *FILES, DOCTOR))
    options = parser.parse_args(words)
    if options.version:
        from ..support.version import version

        print(f"desaxe {version()}")
        return 0
    if not hasattr(options, "run"):
        parser.print_help()
        return 0
    with explained(f"desaxe {words[0]}"), warnings_in_a_line():
        code: int = options.run(options)
        return code


@contextmanager
def warnings_in_a_line() -> Iterator[None]:
    """Print warnings of desaxe without the place in its source."""
    usual = warnings.formatwarning

    def line(message: Any, category: Any, *place: Any, **more: Any) -> str:
        own = category.__module__.startswith("desaxe.")
        return f"desaxe: {printable(message)}\n" if own else usual(message, category, *place, **more)

    warnings.formatwarning = line
    try:
        yield
    finally:
        warnings.formatwarning = usual


def _one_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    text = printable(text)
    return text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
