"""Speed and frame of a serial line."""

import re
from dataclasses import dataclass

_TEXT = re.compile(r"(\d+) ([78])([NEO])([12])")


@dataclass(frozen=True, slots=True)
class LineFormat:
    """What both ends of a serial line must agree on; written as ``115200 8N1``."""

    baud: int
    data_bits: int = 8
    parity: str = "N"
    """``N`` none, ``E`` even, ``O`` odd."""
    stop_bits: int = 1

    @classmethod
    def parse(cls, text: str) -> "LineFormat":
        """Return the format that a text names.

        Raises:
            ValueError: it names none.

        >>> LineFormat.parse("19200 7E1")
        LineFormat(baud=19200, data_bits=7, parity='E', stop_bits=1)
        """
        found = _TEXT.fullmatch(text)
        if found is None or int(found[1]) == 0:  # a speed of 0 tells a terminal to hang up
            raise ValueError(f"expected a speed and a frame as in '115200 8N1' or '19200 7E1', got {text!r}")
        return cls(int(found[1]), int(found[2]), found[3], int(found[4]))

    def __str__(self) -> str:
        """Return the text that :meth:`parse` understands."""
        return f"{self.baud} {self.data_bits}{self.parity}{self.stop_bits}"
