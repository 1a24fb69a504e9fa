"""What a daemon of an earlier version recorded replays to its old digests, for as long as nothing in its path changes.

``begun_map.mcap`` was made by 0.1: a map begun, its first stop swept and laid in, and Ctrl-C on the way to the second.
Where a change of ours means to come to something else, the CHANGELOG says so, and a recording of the version before
takes this one's place.
"""

from pathlib import Path

import pytest

from robotd.recording.entries import ResultEntry
from robotd.recording.reader import read
from tests.support.replayed import check, replayed

OLD = Path(__file__).parent / "old_recordings"
DIGESTS = {"begun_map.mcap": "e1fbc108b48179b88ecead28ca8b26d7b32b3bf7c9d99cb68fa66fdf41a132c8"}


@pytest.mark.parametrize("name", DIGESTS)
def test_an_old_recording_replays_to_its_old_digest(name: str) -> None:
    report = replayed(OLD / name)
    check(report)
    assert report.digest == DIGESTS[name]
    assert report.recorded_by == "0.1.0"


def test_it_holds_what_a_mission_comes_to() -> None:
    kinds = {entry.kind for entry in read(OLD / "begun_map.mcap").entries if isinstance(entry, ResultEntry)}
    assert kinds == {"estimate", "map", "sweep", "mission"}
