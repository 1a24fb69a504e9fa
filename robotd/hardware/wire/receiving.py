"""What the receiving half of every dialect keeps: the beginning of a message, and what was counted."""


class Receiving:
    """Messages are cut out of what came so far; what is left is the beginning of the next one."""

    def __init__(self, *counted: str) -> None:
        """Begin with nothing; ``counted`` names what this dialect counts besides the bytes that it skips."""
        self._begun = bytearray()
        self._counters = dict.fromkeys((*counted, "bytes_skipped"), 0)

    @property
    def counters(self) -> dict[str, int]:
        """What was counted since start."""
        return self._counters

    def reset(self) -> None:
        """Forget the beginning of a message: a line that is opened again does not go on with it."""
        self._begun.clear()

    def _skip(self, count: int | None = None) -> None:
        """Let go of bytes that begin no message: of the first ones, or of all."""
        skipped = len(self._begun) if count is None else count
        self._counters["bytes_skipped"] += skipped
        del self._begun[:skipped]
