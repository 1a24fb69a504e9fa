"""PROTOCOL.md says what the declarations say, and the generator notices when it does not."""

from pathlib import Path

import pytest

from firmware_proto import generate
from firmware_proto.common import BoardKind
from firmware_proto.dictionary import messages_for


def test_protocol_is_not_stale(capsys: pytest.CaptureFixture[str]) -> None:
    assert generate.main(["--check"]) == 0, capsys.readouterr().out


def test_check_fails_on_a_stale_file_and_writing_mends_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fresh = (generate.HERE / "PROTOCOL.md").read_text(encoding="utf-8")
    copied = tmp_path / "PROTOCOL.md"
    copied.write_text(fresh.replace("`speed_mmps`", "`speed`"), encoding="utf-8")
    monkeypatch.setattr(generate, "HERE", tmp_path)
    assert generate.main(["--check"]) == 1
    assert "`speed`" in copied.read_text(encoding="utf-8")
    assert generate.main([]) == 0
    assert copied.read_text(encoding="utf-8") == fresh
    assert generate.main(["--check"]) == 0


def test_every_message_is_in_the_document() -> None:
    document = (generate.HERE / "PROTOCOL.md").read_text(encoding="utf-8")
    for kind in BoardKind:
        for message in messages_for(kind):
            assert f"#### `0x{message.TYPE:02X}` {message.__name__}\n" in document


def test_every_enumeration_is_in_the_document() -> None:
    document = (generate.HERE / "PROTOCOL.md").read_text(encoding="utf-8")
    for one in generate.declared_enums():
        assert f"#### {one.__name__}\n" in document


def test_an_unknown_marker_is_an_error() -> None:
    with pytest.raises(KeyError, match="nothing"):
        generate.filled("<!-- generated: nothing -->\n<!-- end -->")


def test_text_outside_the_markers_is_left_alone() -> None:
    assert generate.filled("# Free text\n") == "# Free text\n"
