"""A difference is shown as what was expected, what came, when, and on which line."""

from robotd.hardware.link.tap import Direction
from robotd.recording.comparison import REACTION_NS, Difference, compare, results_digest
from robotd.recording.entries import BytesEntry, ComputedEntry, Entry, RecordingHeader, ResultEntry
from robotd.recording.reader import Recording

HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
LATE_NS = 10 * REACTION_NS


def asked(time_ns: int, text: bytes, device: str = "drive") -> BytesEntry:
    return BytesEntry(time_ns, device, Direction.TO_BOARD, text)


def words_but_pings(device: str, data: bytes) -> list[str]:
    return [word for word in data.decode().split() if word != "ping"]


def differences(expected: list[Entry], actual: list[Entry]) -> tuple[Difference, ...]:
    end = ComputedEntry(LATE_NS, "end", 0)
    return compare(Recording(HEADER, (*expected, end)), actual, words_but_pings)


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
    heard = BytesEntry(1, "drive", Direction.FROM_BOARD, b"tick")
    assert differences([heard], []) == ()


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
