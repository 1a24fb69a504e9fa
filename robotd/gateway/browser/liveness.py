"""Whether the page of a browser is alive: numbered questions, which its main thread has to answer.

An open socket proves nothing, nor does a ping, which the browser answers by itself while the page hangs.
"""

EVERY_S = 0.25


class Liveness:
    """The questions to one page, and when the last of them was answered."""

    def __init__(self, now_s: float) -> None:
        self._number = 0
        self._answered = 0
        self._heard_s = now_s

    def ask(self) -> int:
        """Return the number of the next question."""
        self._number += 1
        return self._number

    def answer(self, number: int, now_s: float) -> bool:
        """Take an answer; one to a question that was not asked, or that was answered already, is none."""
        if not self._answered < number <= self._number:
            return False
        self._answered = number
        self._heard_s = now_s
        return True

    def silent_s(self, now_s: float) -> float:
        """Return for how long no question was answered."""
        return now_s - self._heard_s
