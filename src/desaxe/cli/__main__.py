"""`python -m desaxe.cli`: the command `desaxe`."""

import sys

from .command import main

sys.exit(main())
