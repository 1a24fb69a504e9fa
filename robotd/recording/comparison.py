"""Judges a replay: did the same bytes lead to the same requests and the same results?"""

import hashlib
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from robotd.core.clock import NS_PER_S
from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.hardware.wire.word import Repeat, Word, Words
from robotd.recording.entries import BytesEntry, Entry, ResultEntry
from robotd.recording.reader import Recording

RESULTS = "results"
"""Stands for a device in a difference between results."""
REACTION_NS = NS_PER_S // 10
"""What the daemon had no time to answer before a recording ended is not missing from it."""
NOTHING = "nothing"

RETRY_NS = 5_000_000
"""Nobody tries again sooner: a request said twice within this is two."""


@dataclass(frozen=True, slots=True)
class Difference:
    """Where a replay left the recording; what follows on the same line is not compared."""

    time_ns: int
    """When, in the recording; in the replay, if the recording has nothing there."""
    device: str
    """Whose line it was, or ``results``."""
    expected: str
    actual: str

    def __str__(self) -> str:
        """Say it in a line."""
        return f"{self.time_ns / NS_PER_S:.6f} s {self.device}: expected {self.expected}, got {self.actual}"


@dataclass(frozen=True, slots=True)
class _Step:
    time_ns: int
    text: str


def compare(recording: Recording, replayed: Sequence[Entry], words: Mapping[str, Words]) -> tuple[Difference, ...]:
    """Return the first difference of every line and of the results, in order of time; empty if there is none.

    Args:
        recording: what happened.
        replayed: what the daemon's journal noted during the replay.
        words: what the requests to each device mean, in its dialect; how often a set-point is renewed, or anything
            else at the machine's pace, they leave out.

    Raises:
        RecordingError: there are bytes of a device, and no words for them.
    """
    for device in recording.devices:
        if device not in words:
            raise RecordingError(f"nothing says what the recorded bytes to {device} mean: they cannot be compared")
    expected_results, actual_results = _results(recording.entries), _results(replayed)
    differences = [
        _first_difference(RESULTS, iter(expected_results[kind]), iter(actual_results[kind]), recording.end_ns)
        # Kind by kind: across them no order was promised, see :func:`_results`.
        for kind in sorted(expected_results.keys() | actual_results.keys())
    ]
    for device in recording.devices:
        expected, actual = (_requests(entries, device, words[device]) for entries in (recording.entries, replayed))
        differences.append(_first_difference(device, expected, actual, recording.end_ns))
    found = [difference for difference in differences if difference is not None]
    return tuple(sorted(found, key=lambda difference: difference.time_ns))


def results_digest(entries: Sequence[Entry]) -> str:
    """Return one SHA-256 over all results, in hexadecimal: equal for two replays exactly if all results are."""
    lines = (f"{step.text}\n" for _, steps in sorted(_results(entries).items()) for step in steps)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _results(entries: Sequence[Entry]) -> defaultdict[str, list[_Step]]:
    """Return the results by their kind, each kind in order.

    Across kinds there is no order to keep: an estimate comes from the worker thread and the sweep that it belongs to
    from the lines, and which of two that come within a millisecond is noted first is up to the machine.
    """
    found: defaultdict[str, list[_Step]] = defaultdict(list)
    for entry in entries:
        if isinstance(entry, ResultEntry):
            found[entry.kind].append(_Step(entry.time_ns, f"{entry.kind} {entry.digest}"))
    return found


def _requests(entries: Sequence[Entry], device: str, words: Words) -> Iterator[_Step]:
    """Yield what a device was asked for; what was said again although it was the same request is there once."""
    said = _SaidLast()
    for entry in entries:
        if not isinstance(entry, BytesEntry) or entry.device != device:
            continue
        if entry.direction is Direction.FROM_BOARD:
            # Any bytes: what the board said is the same in both, and only whether it said something matters
            # here.
            said.is_answered = True
            continue
        for word in words(entry.data):
            if not said.again(word, entry.time_ns):
                yield _Step(entry.time_ns, word.text)


class _SaidLast:
    """The last request on a line, and what has been said until obeyed since the one before."""

    def __init__(self) -> None:
        self._word: Word | None = None
        self._time_ns = 0
        self._stops: set[str] = set()
        self.is_answered = False

    def again(self, word: Word, time_ns: int) -> bool:
        """Take the next request, and say whether it is the one before, tried again."""
        if word.repeat is Repeat.UNTIL_OBEYED:
            is_again = word.text in self._stops
            self._stops.add(word.text)  # the axes of a base are halted in turns
            return is_again
        is_same = word == self._word and not self._stops and time_ns - self._time_ns >= RETRY_NS
        is_again = is_same and (word.repeat is Repeat.NUMBERED or not self.is_answered)
        self._word, self._time_ns, self.is_answered = word, time_ns, False
        self._stops.clear()
        return is_again


def _first_difference(
    device: str, expected: Iterator[_Step], actual: Iterator[_Step], end_ns: int
) -> Difference | None:
    for wanted, found in zip_longest(expected, actual):
        if wanted is None:
            # A recording may be cut in the middle of what its last input led to.
            surely_missing = found.time_ns < end_ns - REACTION_NS
            return Difference(found.time_ns, device, NOTHING, found.text) if surely_missing else None
        if found is None or wanted.text != found.text:
            return Difference(wanted.time_ns, device, wanted.text, NOTHING if found is None else found.text)
    return None
