"""SCIP 2.0, the ASCII dialect of Hokuyo's laser scanners (URG, UBG, UHG, UTM, UST): bytes and messages.

A command is a line; its answer is a block of lines that an empty one ends: the command again, two characters of status
and their sum, and further lines, each with a sum of its own at its end. A sum is the low six bits of the sum of the
characters before it, made printable by adding 30h; where a semicolon comes before it (``DMIN:20;4``), it stands outside
the sum. A distance is three such characters of six bits each.

Facts and examples are those of the maker's "Communication Protocol Specification for SCIP2.0 Standard" (C-42-03320B)
and of its wiki, but for three: that a semicolon is not summed is computed from their examples, for the two contradict
each other; the codes of the UST are taken to be those of the UTM; and ``1Dh`` is an example from memory.
"""

import enum
from dataclasses import dataclass

from robotd.hardware.wire.enquiry import Enquiry
from robotd.hardware.wire.receiving import Receiving
from robotd.hardware.wire.word import Word, typed

LINE_MAX_BYTES = 128
"""Data come in lines of 64 characters and a sum; what is longer than this is noise."""
BLOCK_MAX_LINES = 200
"""A scan of a turn in steps of an eighth of a degree has 136 lines; what is longer is no block."""
_OFFSET = 0x30
_SIX_BITS = 0x3F
_CHARACTERS = 3
_STAMP_CHARACTERS = 4

OK, DATA = "00", "99"
"""Status of a command that was understood, and of the data that follow on an ``M`` command."""


class ScipVerdict(enum.StrEnum):
    """What a distance below the shortest that can be measured stands for."""

    NOTHING = "nothing"
    """Nothing in range."""
    TOO_NEAR = "too_near"
    WEAK = "weak"
    SATURATED = "saturated"
    UNKNOWN = "unknown"


_CODES_OF_TIME_OF_FLIGHT = {1: ScipVerdict.NOTHING, 2: ScipVerdict.TOO_NEAR, 4: ScipVerdict.TOO_NEAR}
"""UTM-30LX, table 4; taken for the younger UST, too, which is not written there."""
_CODES_OF_PHASE_SHIFT = {1: ScipVerdict.WEAK, 2: ScipVerdict.WEAK, 18: ScipVerdict.SATURATED}
"""URG-04LX, UBG-05LX, UHG-08LX, table 3. Its 0, "possibly at 22 m", is nothing to build on."""


@dataclass(frozen=True, slots=True)
class ScipReply:
    """One answer whose sums were right."""

    command: str
    status: str
    lines: tuple[str, ...] = ()
    """What followed, without sums."""

    @property
    def distances_mm(self) -> tuple[int, ...] | None:
        """The distances of a scan, codes for none among them; None if it is no scan."""
        if not self.lines or len(self.lines[0]) != _STAMP_CHARACTERS:
            return None
        text = "".join(self.lines[1:])
        if len(text) % _CHARACTERS or not all(_OFFSET <= ord(character) <= _OFFSET + _SIX_BITS for character in text):
            return None
        return tuple(decoded(text[at : at + _CHARACTERS]) for at in range(0, len(text), _CHARACTERS))


@dataclass(frozen=True, slots=True)
class Parameters:
    """What a scanner says of itself on ``PP``."""

    model: str
    range_min_mm: int
    range_max_mm: int
    steps_per_turn: int
    first_step: int
    last_step: int
    front_step: int

    @classmethod
    def of(cls, reply: ScipReply) -> "Parameters | None":
        """Return what an answer says; None if something is missing or cannot be."""
        said = dict(line.partition(":")[::2] for line in reply.lines)
        try:
            numbers = [int(said[key]) for key in ("DMIN", "DMAX", "ARES", "AMIN", "AMAX", "AFRT")]
        except (KeyError, ValueError):
            return None
        found = cls(said.get("MODL", ""), *numbers)
        is_possible = 0 <= found.first_step < found.last_step <= 2 * found.steps_per_turn < _STEPS_MAX
        is_ranged = 0 <= found.range_min_mm < found.range_max_mm
        return found if is_possible and is_ranged and 0 <= found.front_step <= found.last_step else None

    def verdict(self, distance_mm: int) -> ScipVerdict | None:
        """Return why a distance is none; None if it is one."""
        # Codes are numbers below the shortest distance, so the bounds come first.
        if self.range_min_mm <= distance_mm <= self.range_max_mm:
            return None
        # What a code means depends on how light is timed, and only the name of the model tells that.
        is_time_of_flight = self.model.startswith(("UTM", "UST", "UXM"))
        codes = _CODES_OF_TIME_OF_FLIGHT if is_time_of_flight else _CODES_OF_PHASE_SHIFT
        return codes.get(distance_mm, ScipVerdict.UNKNOWN)


_STEPS_MAX = 20_000
"""More than any scanner has: bounds the scan that a lying one would have us ask for."""


def command(text: str) -> bytes:
    """Return a command."""
    return f"{text}\n".encode("ascii")


PARAMETERS, QUIT, USE_SCIP2 = command("PP"), command("QT"), command("SCIP2.0")


def one_scan(first_step: int, last_step: int) -> bytes:
    """Return the command for one scan, taken after it came; the light goes on and off by itself."""
    return command(f"MD{first_step:04d}{last_step:04d}00001")


def sum_of(text: str) -> str:
    """Return the sum of a line.

    >>> sum_of("00"), sum_of("99"), sum_of("DMIN:20")
    ('P', 'b', '4')
    """
    return chr((sum(map(ord, text)) & _SIX_BITS) + _OFFSET)


def decoded(characters: str) -> int:
    """Return a number of six bits a character.

    >>> decoded("1Dh")
    5432
    """
    number = 0
    for character in characters:
        number = number << 6 | (ord(character) - _OFFSET & _SIX_BITS)
    return number


class ScipWire(Receiving):
    """The receiving half."""

    def __init__(self) -> None:
        super().__init__("replies", "sum_errors")
        self._block: list[str] = []

    def feed(self, data: bytes) -> list[ScipReply]:
        """Take bytes as they come; return the messages that are whole now."""
        replies: list[ScipReply] = []
        for byte in data:
            if byte == 0x0A:
                replies += self._end_line()
            # Ends of lines may be LF or CR LF; the rule that an empty line ends a block holds for both.
            elif byte != 0x0D:
                self._begun.append(byte)
                if len(self._begun) > LINE_MAX_BYTES:
                    self._skip()
        return replies

    def reset(self) -> None:
        """Forget the beginning of a block."""
        super().reset()
        self._block.clear()

    def _end_line(self) -> list[ScipReply]:
        if not self._begun:
            return self._end_block()
        if any(not 0x20 <= byte < 0x7F for byte in self._begun) or len(self._block) == BLOCK_MAX_LINES:
            self._skip()
            return []
        self._block.append(self._begun.decode("ascii"))
        self._begun.clear()
        return []

    def _end_block(self) -> list[ScipReply]:
        block, self._block = self._block, []
        if not block:
            return []
        lines = [_checked(line) for line in block[1:]]
        whole = [line for line in lines if line is not None]
        if not whole or len(whole) != len(lines):
            self._counters["sum_errors"] += 1
            return []
        self._counters["replies"] += 1
        return [ScipReply(block[0], whole[0], tuple(whole[1:]))]


def _checked(line: str) -> str | None:
    """Return a line without its sum; None if the sum is wrong."""
    text, said = line[:-1], line[-1]
    if sum_of(text) == said:
        return text
    return text[:-1] if text.endswith(";") and sum_of(text[:-1]) == said else None


def _model(reply: ScipReply) -> str | None:
    found = Parameters.of(reply) if reply.command == "PP" else None
    return None if found is None else found.model or "a scanner"


ENQUIRY = Enquiry(USE_SCIP2 + PARAMETERS, ScipWire, _model)
"""What it is; the light stays off."""


def requests(data: bytes) -> list[Word]:
    """Return what bytes to the scanner ask for, in words: without what it is, which is asked to see that it lives."""
    return typed(data, b"\n", left_out=("PP",))
