"""A daemon that is only played, as far as the command line can see."""

from collections.abc import Iterator
from dataclasses import replace
from types import TracebackType
from typing import Any, Self

import numpy as np
import pytest

from robotd.client.feed import Gap
from robotd.client.mission_run import MissionEvent
from robotd.contract.answers import HelloResult, MapEntryInfo, RecordingInfo, RecordingList
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress, Status, SweepProgress
from robotd.contract.metrics import Buckets, Metrics, Sample
from robotd.contract.missions import Mission
from robotd.contract.modes import Mode
from robotd.contract.topics import Published
from robotd.contract.ways import Hindrance, Way
from robotd.core.errors import MissionError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2

STATUS = Status(
    time_ns=1,
    mode=Mode.IDLE,
    reason="armed by request",
    devices=(
        DeviceStatus("drive", LinkState.READY, armed=True, counters=(("frames", 1203), ("retries", 0))),
        DeviceStatus("pantilt", LinkState.ABSENT, armed=False),
    ),
    battery_v=24.5,
    bumpers_rad=(),
    mission_id=None,
    map_id=None,
    map_name=None,
    recording=None,
)
REGION = Region(
    belief=0.98,
    pose=Pose2(1.0, 2.0, 0.0),
    covariance=((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-5)),
    residual_m=0.02,
    centre=Pose2(1.0, 2.0, 0.0),
    extent=Extent(0.9, 1.1, 1.9, 2.1, -0.1, 0.1),
    circle=Circle(1.0, 2.0, 0.15),
    cover=Cover(1, ((40, 20, 21), (41, 20, 21))),
    cells=4,
    poses=4,
    best_rank=280,
    explained=(True,) * 280 + (False,) * 20,
)
ESTIMATE = PoseEstimate(5, PoseState.LOCALIZED, REGION.centre, (REGION,), 280, 300, final=True, map_id="m")
AMBIGUOUS = PoseEstimate(4, PoseState.AMBIGUOUS, None, (REGION, REGION), 140, 150, final=False, map_id="m")
ENTRY = MapEntryInfo("lab", 3, "abcdef0123456789", 1_700_000_000_000_000_000, 40, 60, 0.05, stops=7)
MISSION_EVENTS: tuple[MissionEvent, ...] = (
    MissionProgress(1, 7, "localize", MissionPhase.STARTED, 0, 1),
    SweepProgress(2, 1, 150, 300, 120, 20, 10),
    AMBIGUOUS,
    SweepProgress(3, 1, 300, 300, 240, 40, 20),
    ESTIMATE,
    MissionProgress(6, 7, "localize", MissionPhase.DONE, 0, 1, "localized"),
)


class FakeSubscription:
    def __init__(self, events: list[Published | Gap]) -> None:
        self._events = iter(events)

    def next(self, timeout_s: float | None = None) -> Published | Gap | None:
        return next(self._events, None)

    def __iter__(self) -> Iterator[Published | Gap]:
        return self._events

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        return None


class FakeClient:
    """Notes what was asked, answers what it is given."""

    def __init__(self) -> None:
        self.asked: list[Any] = []
        self.mission_events: tuple[MissionEvent, ...] = MISSION_EVENTS
        self.raises: BaseException | None = None
        self.damage: str | None = None
        self.published: list[Published | Gap] = [ESTIMATE]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.asked.append("close")

    def hello(self) -> HelloResult:
        if isinstance(self.raises, Exception):
            raise self.raises
        return HelloResult((1,), "0.9", "s", 0.5, 2, 0)

    def status(self) -> Status:
        if isinstance(self.raises, Exception):
            raise self.raises
        return STATUS

    def metrics(self) -> Metrics:
        return Metrics(
            (Sample("missions_total", {"kind": "map", "end": "done"}, 2),),
            (Sample("compute_queue", {}, 0.0),),
            (Buckets("loop_lag_seconds", {}, (0.001, 0.0025), (7, 9, 10), 0.5),),
        )

    def arm(self) -> None:
        self.asked.append("arm")

    def disarm(self) -> None:
        self.asked.append("disarm")

    def stop(self, reason: str) -> None:
        self.asked.append(("stop", reason))
        if isinstance(self.raises, Exception):
            raise self.raises

    def clear(self) -> None:
        self.asked.append("clear")

    def run_mission(self, mission: Mission) -> Iterator[MissionEvent]:
        self.asked.append(mission)
        yield from self.mission_events
        if self.raises is not None:
            raise self.raises
        last = self.mission_events[-1]
        if isinstance(last, MissionProgress) and last.phase is not MissionPhase.DONE:
            raise MissionError(f"{last.kind} {last.phase}: {last.message}")

    def map_save(self, name: str | None) -> MapEntryInfo:
        self.asked.append(("map_save", name))
        return ENTRY

    def map_load(self, name: str, version: int | None, robot: Pose2 | None) -> MapEntryInfo:
        self.asked.append(("map_load", name, version, robot))
        return ENTRY

    def map_discard(self) -> None:
        self.asked.append("map_discard")

    def map_list(self) -> tuple[MapEntryInfo, ...]:
        return (replace(ENTRY, damage=self.damage),)

    def map_show(self, name: str | None, version: int | None) -> MapChanged:
        self.asked.append(("map_show", name, version))
        values = np.full((6, 6), 128, np.uint8)
        values[1:5, 1:5] = 255
        values[2:4, 2:4] = 0
        spec = GridSpec(0.1, 0.0, 0.0, (6, 6))
        return MapChanged(1, "abc", 2, spec, whole=True, cells=np.empty(0, np.intp), values=values, stops=7)

    def plan_to(self, x_m: float, y_m: float) -> Way:
        self.asked.append(("plan_to", x_m, y_m))
        if x_m < 0.0:
            return Way((), 0.0, Hindrance.OUTSIDE, "the goal lies outside the map", (0.5, 1.0))
        return Way(((1.0, 0.0), (x_m, y_m)), 3.25)

    def record_list(self) -> RecordingList:
        return RecordingList((RecordingInfo("monday.mcap", 2_500_000, 1_700_000_000_000_000_000, True),), 2)

    def record_delete(self, path: str) -> None:
        self.asked.append(("record_delete", path))

    def record_start(self, path: str | None) -> str | None:
        self.asked.append(("record_start", path))
        return path or "recordings/new.mcap"

    def record_stop(self) -> str | None:
        return "recordings/new.mcap"

    def subscribe(self, *topics: str) -> FakeSubscription:
        self.asked.append(("subscribe", *topics))
        return FakeSubscription(self.published)


@pytest.fixture
def client(monkeypatch: pytest.MonkeyPatch) -> FakeClient:
    """Every verb meets this client in place of a daemon."""
    fake = FakeClient()
    for user in (
        "verbs.status_and_arming",
        "verbs.maps",
        "motion",
        "verbs.recordings",
        "verbs.where",
        "verbs.map_making",
        "live",
    ):
        monkeypatch.setattr(f"robotd.cli.{user}.connect", lambda arguments: fake)
    return fake
