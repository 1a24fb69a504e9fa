"""Text of others becomes one bounded line of letters."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from robotd.core.text import printable, printable_bytes, printable_lines

ESCAPED = {
    "a newline": ("a\nb", "a\\nb"),
    "a carriage return": ("a\rb", "a\\rb"),
    "a sequence for the terminal": ("\x1b[31mred\x1b[0m", "\\x1b[31mred\\x1b[0m"),
    "its one-byte form": ("\x9b31m", "\\x9b31m"),
    "a bell": ("\a", "\\x07"),
    "a backspace": ("ok\b\bno", "ok\\x08\\x08no"),
    "writing turned round": ("\u202eabc\u202c", "\\u202eabc\\u202c"),
    "isolates": ("\u2066a\u2069", "\\u2066a\\u2069"),
    "nothing of no width": ("a\u200bb", "a\\u200bb"),
    "a line separator": ("a\u2028b", "a\\u2028b"),
    "a next line": ("a\x85b", "a\\x85b"),
    "half a letter": ("\ud800", "\\ud800"),
    "letters of all kinds": ("Büro 事務所 é \U0001f916", "Büro 事務所 é \U0001f916"),
}


@pytest.mark.parametrize(("text", "shown"), ESCAPED.values(), ids=ESCAPED.keys())
def test_what_means_more_than_itself_is_escaped(text: str, shown: str) -> None:
    assert printable(text) == shown
    assert printable(printable(text)) == shown


@given(st.text(st.characters()), st.integers(0, 60))
@settings(max_examples=300)
@example("\ud800\n" * 99, 10)
@example("x" * 50_000, 200)
def test_a_text_is_one_line_within_bounds_and_has_a_form_in_utf_8(text: str, longest: int) -> None:
    shown = printable(text, longest)
    assert shown.isprintable()
    assert len(shown) <= longest
    shown.encode()
    if text.isprintable() and len(text) <= longest:
        assert shown == text


@given(st.binary(max_size=300))
@settings(max_examples=200)
def test_bytes_are_shown_whatever_they_are(data: bytes) -> None:
    assert printable_bytes(data).isprintable()


def test_lines_stay_lines() -> None:
    assert printable_lines("a\nb\r\x1b[2J\n\n") == "a\nb\\r\\x1b[2J\n\n"
