"""`python3 -m panwright COMMAND …`: the program `panwright`."""

import sys

from . import _core

sys.exit(_core.run_command(sys.argv[1:]))
