"""What every emulator does with its answers, and what those that never speak unasked do with time."""


class Speaking:
    """Collects what it says, until its host fetches it."""

    def __init__(self) -> None:
        self._said = bytearray()

    def take_output(self) -> bytes:
        """Return, once, what it has for the host."""
        said = bytes(self._said)
        self._said.clear()
        return said


class SpeakingWhenAsked(Speaking):
    """Says nothing unasked, so time alone changes nothing."""

    def advance(self, now_us: int) -> None:
        """Let time pass."""

    @property
    def next_event_us(self) -> int | None:
        """Nothing is to come."""
        return None
