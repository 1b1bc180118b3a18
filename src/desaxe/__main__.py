"""`python -m desaxe`: the same as the command `desaxe`."""

import sys

from .cli import main

if __name__ == "__main__":
    sys.exit(main())
