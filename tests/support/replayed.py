"""A recording replayed from within a test that has a loop of its own."""

import threading
from pathlib import Path

from robotd.app.replaying import ReplayReport, replay_recording


def replayed(file: Path) -> ReplayReport:
    """Replay on a thread: a loop cannot be started inside another."""
    reports: list[ReplayReport] = []
    thread = threading.Thread(target=lambda: reports.append(replay_recording(file)))
    thread.start()
    thread.join()
    return reports[0]


def check(report: ReplayReport) -> None:
    assert report.differences == ()
    assert report.complete
    assert report.digest == report.recorded_digest
    assert report.results > 0
