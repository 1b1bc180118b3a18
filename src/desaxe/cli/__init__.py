"""The command `desaxe`.

command  the sub-commands, and how errors reach the terminal
parser   what they share: one-line complaints, help, the sign convention
point, scene, fit, errata, checks   the sub-commands, a file for each group
words    names and inputs as words of a command line
cache    the folder of compiled kernels
doctor   what is installed, and whether loops vectorise here
"""

from .command import main as main
