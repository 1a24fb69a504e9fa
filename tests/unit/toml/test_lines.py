"""The scanner agrees with tomllib about which keys there are, and knows where they stand."""

import tomllib
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.toml.lines import key_lines, line_of

TEXT = '''
a = 1 # [no]
"b c".d = """ x = 3
[nope]
""" # c
[s] # x = 1
arr = [ # comment ]
  "]", 3,
  4 ]
q = 'a # b = 3'
[ s . t ]
u = { v = 3, w = "=" }
["quo.ted"]
x = "\\"="
'''


def test_keys_stand_where_they_stand() -> None:
    assert key_lines(TEXT) == {
        ("a",): 2,
        ("b c",): 3,
        ("b c", "d"): 3,
        ("s",): 6,
        ("s", "arr"): 7,
        ("s", "q"): 10,
        ("s", "t"): 11,
        ("s", "t", "u"): 12,
        ("quo.ted",): 13,
        ("quo.ted", "x"): 14,
    }


def test_what_is_not_listed_stands_where_its_table_stands() -> None:
    lines = key_lines(TEXT)
    assert line_of(lines, ("s", "t", "u", "v")) == 12
    assert line_of(lines, ("s", "nothing")) == 6
    assert line_of(lines, ("nothing",)) is None


def test_line_ends_of_other_systems_count_once() -> None:
    assert key_lines("a = 1\r\n\r\nb = 2\r\n") == {("a",): 1, ("b",): 3}


_VALUES = st.sampled_from(
    [
        "1",
        '"a # b"',
        "'[x]'",
        "[1, 2]",
        "[\n 1, # ]\n 2\n]",
        '"""\n[t]\nk = 1\n"""',
        "'''\n'x' = \"\n'''",
        "{a = 1, b = [2]}",
    ]
)
_STATEMENTS = st.lists(st.tuples(_VALUES, st.sampled_from(["", " # x = 1", "\n", "\n# [t]\n\n"])), max_size=6)


@settings(max_examples=60)
@given(tables=st.lists(_STATEMENTS, max_size=4))
def test_lines_are_those_the_text_was_written_with(tables: list[list[tuple[str, str]]]) -> None:
    text = ""
    expected: dict[tuple[str, ...], int] = {}
    for number, statements in enumerate(tables):
        expected[(f"t{number}",)] = text.count("\n") + 1
        text += f"[t{number}]\n"
        for index, (value, after) in enumerate(statements):
            expected[(f"t{number}", f"k{index}")] = text.count("\n") + 1
            text += f"k{index} = {value}{after}\n"
    assert key_lines(text) == expected
    parsed: dict[str, Any] = tomllib.loads(text)
    assert {path for path in expected if len(path) == 1} == {(name,) for name in parsed}
