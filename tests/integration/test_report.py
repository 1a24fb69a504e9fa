"""The report of a recording: what the recorded robot did, and that it was computed again to the same."""

import json
from pathlib import Path

import pytest

from robotd.cli.main import main
from tests.support.recorded_session import record_session

pytestmark = pytest.mark.slow


def test_a_recording_becomes_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording, out = record_session(tmp_path), tmp_path / "report.html"
    assert main(["report", str(recording), str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"file": str(out), "missions": 2, "failures": 0}
    text = out.read_text()
    assert "<svg" in text
    assert "localized at x" in text
    assert text.count("<td>swept</td>") == 1
    assert "computed again</th><td><code>the same" in text
    assert main(["report", str(recording), str(out)]) == 0  # a report may be written again, over its own kind alone
    other = tmp_path / "notes.html"
    other.write_text("<title>mine</title>")
    assert main(["report", str(recording), str(other)]) == 1
    assert other.read_text() == "<title>mine</title>"
