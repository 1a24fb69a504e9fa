"""A line of the log that may be said often, said seldom: what floods a log hides what is in it."""

from robotd.core.clock import NS_PER_S, now_ns


class LogLimit:
    """Lets a few lines through at once, then one in a while, which says how many were left out."""

    def __init__(self, *, burst: int = 10, every_s: float = 1.0) -> None:
        self._burst = burst
        self._every_ns = round(every_s * NS_PER_S)
        self._saved = float(burst)
        self._looked_ns: int | None = None
        self._left_out = 0

    def line(self, text: str) -> str | None:
        """Return the line to log, or None if it is one too many."""
        at_ns = now_ns()
        if self._looked_ns is not None:
            # A quiet while saves up lines again, but never more than a burst.
            self._saved = min(self._burst, self._saved + (at_ns - self._looked_ns) / self._every_ns)
        self._looked_ns = at_ns
        if self._saved < 1.0:
            self._left_out += 1
            return None
        self._saved -= 1.0
        # Told with the next line that passes: a line of its own would be one more of what floods.
        left_out, self._left_out = self._left_out, 0
        return f"{text} ({left_out} more like it were not logged)" if left_out else text
