"""Shared by the commands: a parser with one-line errors, sub-commands, the sign convention."""

import argparse
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, NoReturn

from ..mechanism.spelling import did_you_mean
from ..support.template import file_text, filled
from .words import UsageError

SIGNS = """\
signs: Y points along the slider axis towards the slider, theta turns from +Y towards +X;
       V_C and a_C are positive along +Y (away from the crank), the slider axis is at X = -ec;
       forces are positive along +X and +Y, torques like theta."""

SEE = "see docs/choose.md: which call for which question"
Facts = Mapping[str, str | Sequence[str]]  # place in a help text -> what stands there


class Option(NamedTuple):
    """An option or an argument of a command, with what argparse takes beside its help."""

    name: str
    help: str
    more: Mapping[str, Any] = {}


class Command(NamedTuple):
    """A sub-command: its one-line help, what runs it, its options, facts in the longer help."""

    name: str
    about: str
    run: Callable[[argparse.Namespace], int]
    options: Iterable[Option] = ()
    facts: Callable[[], Facts] = dict
    text: str = ""  # the file of its longer help, if that is not its name


FLAG: Mapping[str, Any] = {"action": "store_true"}
OVERWRITE = Option("--overwrite", "replace a file that desaxe did not write, or that was changed", FLAG)
JSON = Option("--json", "print JSON", FLAG)


class Parser(argparse.ArgumentParser):
    """A parser that reports an error in one line, and reads its longer help when it is asked for."""

    more: Callable[[], str] | None = None

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Refuse what is unknown here, where its command is known, and not in the parser above."""
        result, unknown = super().parse_known_args(args, namespace)
        if unknown:
            hints = (did_you_mean(word, self._option_string_actions) for word in unknown if word[:2] == "--")
            hint = next(filter(None, hints), "")
            self.error(f"unrecognized arguments: {' '.join(unknown)}{'; ' * bool(hint)}{hint.rstrip()}")
        return result, unknown

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


def parser_of(commands: Iterable[Command]) -> Parser:
    """The parser of the command line with these sub-commands."""
    parser = Parser(
        prog="desaxe",
        description="Offset slider-crank: kinematics with exact sensitivities.",
        epilog=f"{SIGNS}\n\n`desaxe COMMAND --help` explains a command and gives examples.",
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=20),
    )
    parser.add_argument("--version", help="print the version and leave", **FLAG)
    several = parser.add_subparsers(title="commands", metavar="COMMAND", parser_class=Parser)
    for one in commands:
        about = f"{one.about[0].upper()}{one.about[1:]}."
        formatter = argparse.RawDescriptionHelpFormatter
        sub = several.add_parser(one.name, help=one.about, description=about, formatter_class=formatter)
        sub.set_defaults(run=one.run, command=one.name)
        sub.more = lambda one=one: filled(
            file_text(__package__, "help", f"{one.text or one.name}.txt"), **one.facts()
        )
        for option in one.options:
            sub.add_argument(option.name, help=option.help, **option.more)
    return parser
