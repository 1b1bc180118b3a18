"""`python -m desaxe`: the command `desaxe`."""

import sys

from .cli.command import main

sys.exit(main())
