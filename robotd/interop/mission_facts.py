"""What a robot did, gathered from what it told: missions, way, stops, looks round, failures, the map at last."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.contract.device_status import DeviceStatus
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress, Status
from robotd.contract.modes import Mode
from robotd.contract.ways import MissionPlan
from robotd.core.grid_spec import GridSpec
from robotd.interop.scene import Scene

_HALTED = (Mode.DISARMED, Mode.FAULT)


@dataclass(frozen=True, slots=True)
class MissionSpan:
    """One mission, from its first word to its last."""

    mission_id: int
    kind: str
    begun_ns: int
    last: MissionProgress
    """What was heard of it last; its end, unless that was not heard."""
    plan: MissionPlan | None = None
    """What it intended last."""


@dataclass(frozen=True, slots=True)
class Halt:
    """The robot was stopped, and may not move any more."""

    time_ns: int
    mode: str
    reason: str


@dataclass(slots=True)
class MissionFacts:
    """Takes the events one after the other."""

    missions: dict[int, MissionSpan] = field(default_factory=dict)
    ways_m: list[list[tuple[float, float]]] = field(default_factory=list)
    """Where the robot was believed to be, without a break each; places of the last map."""
    looks: list[PoseEstimate] = field(default_factory=list)
    """Each look round as it ended."""
    halts: list[Halt] = field(default_factory=list)
    devices: tuple[DeviceStatus, ...] = ()
    """As they were told last."""
    spec: GridSpec | None = None
    """Of the map in use at last."""
    _scene: Scene = field(default_factory=Scene)
    _mode: str = Mode.DISARMED
    _is_lost: bool = True

    @classmethod
    def of(cls, events: Iterable[object]) -> "MissionFacts":
        """Return what these events come to."""
        facts = cls()
        for event in events:
            facts.take(event)
        return facts

    @property
    def cells(self) -> NDArray[np.uint8]:
        """``uint8[rows, cols]`` of that map."""
        return self._scene.cells

    def take(self, event: object) -> None:
        """Take the next event."""
        self._scene.take(event)
        match event:
            case MissionProgress():
                before = self.missions.get(event.mission_id)
                span = before or MissionSpan(event.mission_id, event.kind, event.time_ns, event)
                self.missions[event.mission_id] = replace(span, last=event)
            case MissionPlan() if event.mission_id in self.missions:
                self.missions[event.mission_id] = replace(self.missions[event.mission_id], plan=event)
            case PoseEstimate():
                self._estimate(event)
            case MapChanged() if event.whole:
                self._another_map(event)
            case Status():
                self._status(event)

    @property
    def failures(self) -> list[MissionSpan]:
        """Missions that were not done."""
        return [span for span in self.missions.values() if span.last.phase is not MissionPhase.DONE]

    def _estimate(self, estimate: PoseEstimate) -> None:
        # Without readings it is odometry's word, and nobody looked.
        if estimate.final and estimate.readings:
            self.looks.append(estimate)
        if not estimate.final:
            return
        if estimate.best is None:
            self._is_lost = estimate.state is PoseState.LOST or self._is_lost
            return
        if self._is_lost or not self.ways_m:
            self.ways_m.append([])
        self._is_lost = False
        self.ways_m[-1].append((estimate.best.x_m, estimate.best.y_m))

    def _another_map(self, change: MapChanged) -> None:
        self.spec = None if change.map_id is None else change.spec
        # Places of another map are none of this one.
        self.ways_m, self._is_lost = [], True

    def _status(self, status: Status) -> None:
        self.devices = status.devices
        if status.mode in _HALTED and (self._mode not in _HALTED or status.mode != self._mode):
            self.halts.append(Halt(status.time_ns, status.mode, status.reason))
        self._mode = status.mode
