"""What bytes to a device ask for, in words: for the comparison of a replay with its recording.

Each dialect has words of its own, and leaves out what it asks again and again at the machine's pace. Bytes that are no
request of it are words, too: whatever was written, nothing passes unseen.
"""

import enum
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass

_SHOWN_BYTES = 40


class Repeat(enum.Enum):
    """When a request that is said again is still the same request."""

    UNANSWERED = "unanswered"
    """If nothing was heard since it was said before: it is tried again."""
    NUMBERED = "numbered"
    """Whatever was heard since: it bears its number."""
    UNTIL_OBEYED = "until obeyed"
    """Whatever was heard since: it is said until it is obeyed, and how often that is depends on the machine's pace."""


@dataclass(frozen=True, slots=True)
class Word:
    """One request to a device, as a comparison of two recordings sees it."""

    text: str
    repeat: Repeat = Repeat.UNANSWERED


Words = Callable[[bytes], list[Word]]
"""Says what one piece of bytes, as it was written, asks for."""


def unknown(data: bytes) -> Word:
    """Return the word for what is no request."""
    return Word(f"bytes {data[:_SHOWN_BYTES].hex(' ')}{'...' if len(data) > _SHOWN_BYTES else ''}")


def typed(data: bytes, end: bytes, *, left_out: Collection[str] = (), until_obeyed: Collection[str] = ()) -> list[Word]:
    """Return the words of commands that are typed, each up to ``end``.

    Args:
        data: what was written.
        end: ends each command; what stands before the first may be empty, to end a command that was cut in half.
        left_out: commands that are asked again and again, and change nothing.
        until_obeyed: commands that are said until they are obeyed.
    """
    *commands, rest = data.split(end)
    texts = [command.decode("ascii", errors="backslashreplace") for command in commands if command]
    words = [
        Word(text, Repeat.UNTIL_OBEYED if text in until_obeyed else Repeat.UNANSWERED)
        for text in texts
        if text not in left_out
    ]
    return [*words, unknown(rest)] if rest else words


def whole(data: bytes, understood: Iterable[tuple[bytes, Word | None]]) -> list[Word]:
    """Return the words of frames that together are all of the bytes; otherwise one word for the bytes.

    Args:
        data: what was written.
        understood: the frames in it, each with its word, or with None if it is left out.
    """
    frames = list(understood)
    # Encoded again and compared, for what stands between frames must not pass unseen.
    if b"".join(frame for frame, _ in frames) != data:
        return [unknown(data)]
    return [word for _, word in frames if word is not None]
