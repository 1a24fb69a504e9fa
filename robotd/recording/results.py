"""What a replay must come to again: sweeps, estimates, maps and the ends of missions, each with a digest.

Times are left out of the digests: they are what a replay may change, by the time this host takes to think.
"""

import hashlib
import json
from typing import Any

import msgspec

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MapChanged, MissionProgress, SweepDone
from robotd.core.reading import Sweep
from robotd.recording.encoding import encoded
from robotd.recording.entries import ResultEntry


def map_result(event: MapChanged, digest: str) -> ResultEntry:
    """Return the entry of a map that changed; ``digest`` is that of its whole grid, which the event does not carry."""
    return ResultEntry(event.time_ns, "map", {"map_id": event.map_id, "generation": event.generation}, digest)


def result_of(event: Event) -> ResultEntry | None:
    """Return the entry of a sweep, an estimate or the end of a mission, encoded; None for what is no such result.

    Takes milliseconds for an estimate of many large regions: those are made where they are computed.

    Raises:
        ValueError: the event is a map's: its entry needs the digest of the grid, see :func:`map_result`.
    """
    match event:
        case MapChanged():
            raise ValueError("a changed map is noted by its digest: publish it with map_result")
        case SweepDone():
            return _result(event.time_ns, "sweep", _sweep(event.sweep))
        case PoseEstimate() if event.state is not PoseState.PREDICTED:
            return _result(event.time_ns, "estimate", _estimate(event))
        case MissionProgress() if event.is_last:
            return _result(event.time_ns, "mission", _without_time(msgspec.to_builtins(event)))
        case _:
            return None


def _result(time_ns: int, kind: str, content: dict[str, Any]) -> ResultEntry:
    # Sorted, so that the order in which a class declares its fields is in no digest.
    text = json.dumps(content, sort_keys=True)
    return encoded(ResultEntry(time_ns, kind, content, hashlib.sha256(text.encode()).hexdigest()))


def _estimate(estimate: PoseEstimate) -> dict[str, Any]:
    content = _without_time(msgspec.to_builtins(estimate))
    del content["complete"]
    del content["ends"]  # follows from the readings and the map, and older recordings do not have it
    for name in ("in_odom", "map_from_odom", "mission_id", "sweep"):
        del content[name]  # the same, and the sweep and the missions have them already
    # As in recordings made before these could be said: their digests are of what there was.
    for name, unsaid in _UNSAID.items():
        if content[name] == unsaid:
            del content[name]
    return content


_UNSAID: dict[str, object] = {
    "jumped_m": None,
    "by_history": False,
    "unreachable": 0,
    "contradiction": None,
    "walls": None,
    "smallest_error_m": None,
    "layers": (),
}


def _sweep(sweep: Sweep) -> dict[str, Any]:
    content: dict[str, Any] = msgspec.to_builtins(sweep)
    # Without a word of slants where there are none: as in recordings of before there were any.
    slants = [slant | _without_times(slant) for slant in content.pop("slants")]
    return content | _without_times(content) | ({"slants": slants} if slants else {})


def _without_times(seen: dict[str, Any]) -> dict[str, Any]:
    return {"readings": [_without_time(reading) for reading in seen["readings"]]}


def _without_time(content: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if key != "time_ns"}
