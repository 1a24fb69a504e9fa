"""``make truth`` asks every log in every way, keeps what it was answered, and writes a page of it."""

from pathlib import Path

import pytest

from tests.studies.truth.run import main, questions
from tests.support.recorded_room import drive_lines


def test_a_page_has_a_line_for_each_log_and_size_of_cells(tmp_path: Path) -> None:
    (tmp_path / "room.corrected.log").write_text("\n".join(drive_lines(12)))
    words = ["--data", str(tmp_path), "--share", "0.01", "--only", "cells", "--workers", "1"]
    kept, out = ["--kept", str(tmp_path / "kept")], ["--out", str(tmp_path / "truth")]
    with pytest.raises(SystemExit) as ended:
        main([*words, *kept, *out])
    assert ended.value.code == 0
    [written] = (tmp_path / "truth").glob("*.md")
    rows = [line.split(" | ") for line in written.read_text().splitlines() if line.startswith("| interleaved")]
    assert [row[1:4] for row in rows] == [["room", f"{side} cm", "1"] for side in (5, 10, 20)]
    assert "| 90 to 100 % | " in written.read_text()
    assert "Not looked at: room." in written.read_text()


def test_every_ordered_pair_of_buildings_is_asked() -> None:
    logs = [Path(f"{name}.corrected.log.gz") for name in ("one", "two", "three")]
    pairs = {
        (words[0], word.removeprefix("other="))
        for name, words in questions(logs, 1.0).items()
        if name.startswith("other-")
        for word in words
        if word.startswith("other=")
    }
    assert pairs == {(str(log), str(other)) for log in logs for other in logs if log != other}


def test_without_logs_it_says_what_to_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("ROBOTD_DATA", raising=False)
    for words, said in (([], "set ROBOTD_DATA"), (["--data", str(tmp_path)], "there is no *.corrected.log in")):
        with pytest.raises(SystemExit):
            main(words)
        assert said in capsys.readouterr().err
