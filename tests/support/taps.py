"""A line on which nobody listens in."""

from robotd.hardware.link.tap import Direction


class NoTap:
    """Nobody looks."""

    def bytes_passed(self, device: str, direction: Direction, time_ns: int, data: bytes) -> None:
        """Ignore the bytes."""

    def line_changed(self, device: str, time_ns: int, *, up: bool) -> None:
        """Ignore the change."""

    def line_broke(self, device: str, time_ns: int, reason: str) -> None:
        """Ignore the failure."""
