"""Shared by the commands: a parser with one-line errors, sub-commands, the sign convention."""

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from ..mechanism.spelling import did_you_mean
from ..support.template import file_text, filled
from .words import UsageError

SIGNS = """\
signs: Y points along the slider axis towards the slider, theta turns from +Y towards +X;
       V_C and a_C are positive along +Y (away from the crank), the slider axis is at X = -ec;
       forces are positive along +X and +Y, torques like theta."""

SEE = "see docs/choose.md: which call for which question"


class Parser(argparse.ArgumentParser):
    """A parser that reports an error in one line, and reads its longer help when it is asked for."""

    more: Callable[[], str] | None = None

    def format_help(self) -> str:
        """The help, with the text of a sub-command."""
        if self.more is not None:
            self.epilog = f"{self.more().rstrip()}\n\n{SEE}"
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        """Raise UsageError with the message, and the choice that is similar to a wrong one."""
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from ([^)]*)", message)
        hint = did_you_mean(wrong[1], re.findall(r"[\w-]+", wrong[2])) if wrong else ""
        message = message.replace("(choose from", f"({hint}choose from")
        raise UsageError(f"{message} (see {self.prog} --help)")


class Version(argparse.Action):
    """The action of `--version`: looks the version up only when it is called."""

    def __init__(self, option_strings: Sequence[str], dest: str, **options: Any) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print the version and leave."""
        from ..support.version import version

        print(f"desaxe {version()}")
        parser.exit()


def add_command(
    commands: Any,
    name: str,
    what: str,
    run: Callable[[argparse.Namespace], int],
    facts: Callable[[], Mapping[str, str | Sequence[str]]] = dict,
    text: Callable[[], str] | None = None,
) -> Any:
    """Add a sub-command with its one-line help, and `text` or that of `help/NAME.txt` with these facts."""
    parser = commands.add_parser(
        name,
        help=what,
        description=f"{what[0].upper()}{what[1:]}.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.more = text or (lambda: filled(file_text(__package__, "help", f"{name}.txt"), **facts()))
    return parser
