"""What the exit codes of ``robotctl`` mean."""

from typing import Final

OK: Final = 0
FAILED: Final = 1
WRONG_USAGE: Final = 2
LOST: Final = 3
AMBIGUOUS: Final = 4
BAD_CONFIG: Final = 78
INTERRUPTED: Final = 130
