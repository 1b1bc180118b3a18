"""The command `desaxe`.

command  the sub-commands, and how errors reach the terminal
parser   a parser with one-line errors, help, the sign convention
words    names and inputs as command-line arguments
calls    `desaxe evaluate`, `peak`, `fit` and every other call, by one table
answers  the answer of a call on the terminal, as JSON or CSV, in a file
scene    `desaxe run`, `scene`, `explain`, `compile`, `explore`
sweep    `desaxe sweep`
checks   `desaxe derive`, `doctor`
doctor   the report of `desaxe doctor`
accuracy values beside frozen truths: `desaxe doctor --accuracy`
"""

from .command import main as main
