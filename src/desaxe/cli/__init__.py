"""The command `desaxe`.

command  how words reach a sub-command, and how errors reach the terminal
parser   a parser with one-line errors, help, the sign convention
words    names and inputs as command-line arguments
calls    `desaxe evaluate`, `peak`, `fit` and every other call, by one table
answers  the answer of a call on the terminal, as JSON or CSV, in a file
files    `desaxe run`, `scene`, `sweep`, `explain`, `compile`, `explore`, `derive`, by one table
doctor   `desaxe doctor`: this installation, its values beside frozen truths
"""

import sys

try:
    from .command import main as main
except KeyboardInterrupt:  # before the command could say so itself
    print("desaxe: interrupted", file=sys.stderr)
    sys.exit(130)
