"""A difference is shown as what was expected, what came, when, and on which line."""

import pytest

from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.hardware.wire.word import Repeat, Word
from robotd.recording.comparison import REACTION_NS, RETRY_NS, Difference, compare, results_digest
from robotd.recording.entries import BytesEntry, ComputedEntry, Entry, RecordingHeader, ResultEntry
from robotd.recording.reader import Recording

HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
LATE_NS = 10 * REACTION_NS
DEVICES = ("drive", "pantilt", "laser")
REPEATS = {"#": Repeat.NUMBERED, "!": Repeat.UNTIL_OBEYED}


def asked(time_ns: int, text: bytes, device: str = "drive") -> BytesEntry:
    return BytesEntry(time_ns, device, Direction.TO_BOARD, text)


def words_but_pings(data: bytes) -> list[Word]:
    return [Word(text, REPEATS.get(text[0], Repeat.UNANSWERED)) for text in data.decode().split() if text != "ping"]


def differences(expected: list[Entry], actual: list[Entry]) -> tuple[Difference, ...]:
    end = ComputedEntry(LATE_NS, "end", 0)
    return compare(Recording(HEADER, (*expected, end)), actual, dict.fromkeys(DEVICES, words_but_pings))


def heard(time_ns: int) -> BytesEntry:
    return BytesEntry(time_ns, "drive", Direction.FROM_BOARD, b"tick")


def test_times_chunks_and_what_the_summary_leaves_out_do_not_matter() -> None:
    expected: list[Entry] = [
        asked(1, b"arm aim"),
        ResultEntry(2, "map", {}, "d1"),
        asked(3, b"ping"),
        asked(4, b"shoot"),
    ]
    actual: list[Entry] = [
        asked(1, b"arm"),
        asked(2, b"aim"),
        asked(9, b"ping shoot ping"),
        ResultEntry(9, "map", {"x": 1}, "d1"),
    ]
    assert differences(expected, actual) == ()
    assert results_digest(expected) == results_digest(actual)


def test_the_first_difference_of_every_line_is_told_in_order_of_time() -> None:
    expected: list[Entry] = [asked(1, b"arm aim shoot"), asked(5, b"on", "laser"), ResultEntry(3, "map", {}, "d1")]
    actual: list[Entry] = [asked(1, b"arm shoot aim"), asked(6, b"off", "laser"), ResultEntry(4, "map", {}, "d2")]
    assert differences(expected, actual) == (
        Difference(1, "drive", "aim", "shoot"),
        Difference(3, "results", "map d1", "map d2"),
        Difference(5, "laser", "on", "off"),
    )
    assert results_digest(expected) != results_digest(actual)


def test_what_is_missing_and_what_is_too_much_are_differences() -> None:
    assert differences([asked(1, b"arm aim")], [asked(1, b"arm")]) == (Difference(1, "drive", "aim", "nothing"),)
    assert differences([asked(1, b"arm")], [asked(1, b"arm aim")]) == (Difference(1, "drive", "nothing", "aim"),)


def test_what_the_recording_had_no_time_to_see_is_not_too_much() -> None:
    just_before_the_end = asked(LATE_NS - REACTION_NS + 1, b"aim")
    assert differences([asked(1, b"arm")], [asked(1, b"arm"), just_before_the_end]) == ()
    assert differences([], [ResultEntry(LATE_NS, "map", {}, "d")]) == ()


def test_what_boards_said_is_not_compared() -> None:
    assert differences([heard(1)], []) == ()


def test_a_request_tried_again_is_one_request_and_one_made_again_is_two() -> None:
    later, later_still = 1 + RETRY_NS, 1 + 2 * RETRY_NS
    once: list[Entry] = [asked(1, b"shoot")]
    assert differences(once, [asked(1, b"shoot"), asked(later, b"shoot")]) == ()
    assert differences(once, [asked(1, b"shoot shoot")]) == (Difference(1, "drive", "nothing", "shoot"),)
    again: list[Entry] = [asked(1, b"shoot"), heard(2), asked(later, b"shoot")]
    assert differences(once, again) == (Difference(later, "drive", "nothing", "shoot"),)
    assert differences(again, [*again, heard(later + 1), asked(later_still, b"shoot")]) != ()


@pytest.mark.parametrize("text", [b"#7", b"!halt"])
def test_what_bears_a_number_or_is_said_until_obeyed_is_one_request_whatever_was_heard(text: bytes) -> None:
    again: list[Entry] = [asked(1, text), heard(2), asked(1 + RETRY_NS, text), heard(3 + RETRY_NS)]
    assert differences([asked(1, text)], again) == ()


def test_two_stops_that_are_said_in_turns_are_two() -> None:
    in_turns: list[Entry] = [asked(time_ns, text) for time_ns, text in ((1, b"!a"), (2, b"!b"), (3, b"!a"), (4, b"!b"))]
    assert differences([asked(1, b"!a !b")], in_turns) == ()
    assert differences([asked(1, b"!a aim !a")], [asked(1, b"!a aim")]) == (Difference(1, "drive", "!a", "nothing"),)


def test_bytes_of_a_device_without_words_are_refused() -> None:
    recording = Recording(HEADER, (asked(1, b"aim", "crane"),))
    with pytest.raises(RecordingError, match="bytes to crane"):
        compare(recording, recording.entries, {"drive": words_but_pings})


def test_a_difference_reads_as_a_line() -> None:
    text = str(Difference(1_500_000_000, "pantilt", "Aim(100)", "Aim(101)"))
    assert text == "1.500000 s pantilt: expected Aim(100), got Aim(101)"


def test_which_of_two_kinds_of_results_came_first_is_no_difference() -> None:
    one = (
        ResultEntry(1, "estimate", {}, "e1"),
        ResultEntry(2, "sweep", {}, "s1"),
        ResultEntry(3, "estimate", {}, "e2"),
    )
    other = (
        ResultEntry(1, "estimate", {}, "e1"),
        ResultEntry(2, "estimate", {}, "e2"),
        ResultEntry(3, "sweep", {}, "s1"),
    )
    swapped = (
        ResultEntry(1, "estimate", {}, "e2"),
        ResultEntry(2, "estimate", {}, "e1"),
        ResultEntry(3, "sweep", {}, "s1"),
    )
    assert results_digest(one) == results_digest(other)
    assert results_digest(one) != results_digest(swapped)
