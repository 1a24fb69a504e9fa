"""What takes long to encode is encoded once, where it was made; the message is the same as ever."""

import json
from pathlib import Path
from typing import Any

import pytest

from robotd.recording import encoding
from robotd.recording.encoding import decode, encode, encoded
from robotd.recording.entries import CommandEntry, ComputedEntry, Entry, RecordingHeader, ResultEntry
from robotd.recording.preroll import PrerollJournal
from robotd.recording.reader import read

COMMAND = CommandEntry(5, "use_map", {"grid": {"cells": "x" * 100}, "pose": [1 / 3, None]})
RESULT = ResultEntry(6, "estimate", {"regions": [{"belief": 0.1}]}, "abc")


@pytest.mark.parametrize("entry", [COMMAND, RESULT, ComputedEntry(7, "narrow", 2)])
def test_an_encoded_entry_has_the_same_message_and_is_the_same_entry(entry: Entry) -> None:
    assert encode(encoded(entry)) == encode(entry)
    assert encoded(entry) == entry
    assert decode(encode(entry)[0], entry.time_ns, encode(entry)[1]) == entry


def test_the_message_holds_neither_the_time_nor_itself() -> None:
    assert json.loads(encode(encoded(RESULT))[1]) == {"kind": "estimate", "content": RESULT.content, "digest": "abc"}


def test_to_remember_and_to_record_an_entry_takes_one_encoding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[dict[str, Any]] = []
    dumps = encoding._dumps

    def counted(value: dict[str, Any]) -> bytes:
        made.append(value)
        return dumps(value)

    monkeypatch.setattr(encoding, "_dumps", counted)
    journal = PrerollJournal(RecordingHeader("1", "", 1, 0, 0), 1_000_000)
    already = encoded(RESULT)
    journal.note(COMMAND)
    journal.start(tmp_path / "of.mcap")
    journal.note(already)
    journal.note(RESULT)
    journal.stop()()
    assert sum("arguments" in value or "content" in value for value in made) == 3
    assert list(read(tmp_path / "of.mcap").entries) == [COMMAND, RESULT, RESULT]
