"""A recording of a robot of vendor devices replays to what was recorded, too: nothing in them goes by timers alone.

And every request counts, in every dialect: one that is missing, made twice or another than the recorded one is a
difference.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robotd.app.replaying import replay_recording
from robotd.cli.emulated import config_text, recorded_dialects
from robotd.config import loads
from robotd.contract.missions import Localize, MapStart
from robotd.contract.requests import RecordStart, RecordStop
from robotd.core.clock import NS_PER_S, run_virtual
from robotd.core.errors import RecordingError
from robotd.hardware.devices.catalogue import request_words
from robotd.hardware.link.tap import Direction
from robotd.hardware.wire.word import Repeat, Words
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.comparison import NOTHING, compare
from robotd.recording.entries import BytesEntry, ComputedEntry, Entry, RecordingHeader
from robotd.recording.reader import Recording, read
from robotd.recording.recorder import Recorder
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.fakes.fake_robot import FakeRobot
from robotd.sim.robot import DEVICES, SimulatedRobot

pytestmark = pytest.mark.slow

SAMPLED = 12
"""About this many requests to each device are changed, from the first to the last."""
ROBOTS = (
    Dialects("rwi-ascii", "ptu", "dimetix"),
    Dialects("rflex", "dynamixel", "tfmini-s"),
    Dialects("board", "fixed", "scip"),
    Dialects("board", "board", "lw20"),
    Dialects("board", "board", "lwnx"),
    Dialects("board", "board", "disto"),
    Dialects("board", "board", "tfmini"),
)


async def record(live: Any, path: Path, dialects: Dialects) -> None:
    world = load_world("office")
    text = config_text({device: f"/dev/emulated/{device}" for device in DEVICES}, dialects.settings())
    config = replace(loads(text), sweep=SweepSettings(readings=24))
    async with live(SimulatedRobot(world, seed=5, dialects=dialects), config) as it:
        await it.daemon.control.perform(RecordStart(str(path)))
        await it.done(MapStart.of("office", world.stops_m[:1], world.start_pose))
        await it.done(Localize())
        await it.daemon.control.perform(RecordStop())


def requests(entries: Sequence[Entry], device: str, words: Words) -> Iterator[tuple[int, BytesEntry]]:
    """Yield what was written to a device and is compared, with its place; without stops, which are said in volleys."""
    for at, entry in enumerate(entries):
        if isinstance(entry, BytesEntry) and entry.device == device and entry.direction is Direction.TO_BOARD:
            said = words(entry.data)
            if said and not any(word.repeat is Repeat.UNTIL_OBEYED for word in said):
                yield at, entry


def altered(entry: BytesEntry) -> BytesEntry:
    """Return a piece with another bit in its middle."""
    data = bytearray(entry.data)
    data[len(data) // 2] ^= 0x01
    return replace(entry, data=bytes(data))


def but_for_the_last(entries: Sequence[Entry], device: str) -> Recording:
    """Return a recording of one device alone, which goes on for long enough to miss everything that is missing."""
    header = RecordingHeader("0.2.0", "", 1, 0, 0)
    own = tuple(entry for entry in entries if isinstance(entry, BytesEntry) and entry.device == device)
    return Recording(header, (*own, ComputedEntry(own[-1].time_ns + NS_PER_S, "end", 0)))


CHANGES: dict[str, Callable[[BytesEntry], tuple[BytesEntry, ...]]] = {
    "missing": lambda entry: (),
    "twice": lambda entry: (entry, entry),
    "altered": lambda entry: (altered(entry),),
}


def assert_every_request_counts(recording: Recording, device: str, words: Words) -> None:
    whole = but_for_the_last(recording.entries, device)
    found = list(requests(whole.entries, device, words))
    assert len(found) > 1, device  # one that streams by itself is only greeted
    assert compare(whole, whole.entries, {device: words}) == ()
    for at, entry in found[:: max(1, len(found) // SAMPLED)]:
        for name, change in CHANGES.items():
            other = (*whole.entries[:at], *change(entry), *whole.entries[at + 1 :])
            assert compare(whole, other, {device: words}) != (), (device, name, entry)
            assert compare(replace(whole, entries=other), whole.entries, {device: words}) != (), (device, name, entry)


@pytest.mark.parametrize("dialects", ROBOTS, ids=lambda robot: f"{robot.drive}-{robot.pantilt}-{robot.rangefinder}")
def test_a_replay_comes_to_what_was_recorded(live: Any, tmp_path: Path, dialects: Dialects) -> None:
    run_virtual(record(live, tmp_path / "recordings" / "a.mcap", dialects))
    report = replay_recording(tmp_path / "recordings" / "a.mcap")
    assert report.differences == ()
    assert report.digest == report.recorded_digest
    assert report.results > 3
    recording = read(tmp_path / "recordings" / "a.mcap")
    words = request_words(loads(recording.header.config_text).devices)
    assert set(words) == set(DEVICES) - ({"pantilt"} if dialects.pantilt == "fixed" else set())
    for device, its_words in words.items():
        assert_every_request_counts(recording, device, its_words)


def test_a_replay_sees_that_a_device_was_never_asked(live: Any, tmp_path: Path) -> None:
    run_virtual(record(live, tmp_path / "recordings" / "a.mcap", Dialects("rflex", "dynamixel", "tfmini-s")))
    recording = read(tmp_path / "recordings" / "a.mcap")
    heard = [entry for entry in recording.entries if getattr(entry, "direction", None) is not Direction.TO_BOARD]
    Recorder(tmp_path / "mute.mcap", recording.header, heard).close()
    differences = replay_recording(tmp_path / "mute.mcap").differences
    assert {difference.device for difference in differences if difference.expected == NOTHING} >= set(DEVICES)


def test_the_fake_of_vendor_devices_says_why_there_is_none(live: Any, tmp_path: Path) -> None:
    run_virtual(record(live, tmp_path / "recordings" / "a.mcap", Dialects("rflex", "board", "lw20")))
    recording = read(tmp_path / "recordings" / "a.mcap")
    with pytest.raises(RecordingError, match="a drive that speaks rflex, a rangefinder that speaks lw20"):
        FakeRobot(recording, recorded_dialects(recording))
