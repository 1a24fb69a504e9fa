"""Judges a replay: did the same bytes lead to the same requests and the same results?"""

import hashlib
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from robotd.core.clock import NS_PER_S
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import BytesEntry, Entry, ResultEntry
from robotd.recording.reader import Recording

RESULTS = "results"
"""Stands for a device in a difference between results."""
REACTION_NS = NS_PER_S // 10
"""What the daemon had no time to answer before a recording ended is not missing from it."""
NOTHING = "nothing"

Summarize = Callable[[str, bytes], list[str]]
"""Says what bytes to a device asked for, a line each; what a replay may do differently (pings, how often a set-point
is renewed, retries) it leaves out."""


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


def compare(recording: Recording, replayed: Sequence[Entry], summarize: Summarize) -> tuple[Difference, ...]:
    """Return the first difference of every line and of the results, in order of time; empty if there is none.

    Args:
        recording: what happened.
        replayed: what the daemon's journal noted during the replay.
        summarize: what to compare of the bytes that went to the boards.
    """
    expected_results, actual_results = _results(recording.entries), _results(replayed)
    differences = [
        _first_difference(RESULTS, iter(expected_results[kind]), iter(actual_results[kind]), recording.end_ns)
        for kind in sorted(expected_results.keys() | actual_results.keys())
    ]
    for device in recording.devices:
        expected, actual = (_requests(entries, device, summarize) for entries in (recording.entries, replayed))
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


def _requests(entries: Sequence[Entry], device: str, summarize: Summarize) -> Iterator[_Step]:
    last = ""
    for entry in entries:
        if isinstance(entry, BytesEntry) and entry.device == device and entry.direction is Direction.TO_BOARD:
            for text in summarize(device, entry.data):
                if text != last:  # a request repeated until it was answered is one request
                    yield _Step(entry.time_ns, text)
                last = text


def _first_difference(
    device: str, expected: Iterator[_Step], actual: Iterator[_Step], end_ns: int
) -> Difference | None:
    for wanted, found in zip_longest(expected, actual):
        if wanted is None:
            surely_missing = found.time_ns < end_ns - REACTION_NS
            return Difference(found.time_ns, device, NOTHING, found.text) if surely_missing else None
        if found is None or wanted.text != found.text:
            return Difference(wanted.time_ns, device, wanted.text, NOTHING if found is None else found.text)
    return None
