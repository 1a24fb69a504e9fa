"""The robot on a terminal, as it goes: what was heard so far, drawn again and again."""

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from rich.console import Group, RenderableType
from rich.text import Text

from robotd.cli.show.half_blocks import Ink, draw, shrink
from robotd.cli.show.wording import counts_in_words, estimate_in_words, mission_in_words
from robotd.client.feed import Gap
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import (
    MapChanged,
    MissionProgress,
    Status,
    SweepBegun,
    SweepDone,
    SweepProgress,
    SweepReadings,
)
from robotd.contract.sweep_columns import from_columns
from robotd.contract.topics import LogEntry, Published
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus

_LOG_LINES = 5
KEYS = "keys: space or s stops, a arms, q ends"


@dataclass(slots=True)
class Dashboard:
    """What is known of the robot by now."""

    spec: GridSpec | None = None
    values: NDArray[np.uint8] | None = None
    """The map in use, ``uint8[rows, cols]``."""
    status: Status | None = None
    pose: PoseEstimate | None = None
    mission: MissionProgress | None = None
    sweep: SweepProgress | None = None
    readings: list[RangeReading] = field(default_factory=list)
    """Of the sweep under way, or the last one."""
    taken_at: Pose2 | None = None
    """Where it was taken, map frame; None if that is not known."""
    log: deque[LogEntry] = field(default_factory=lambda: deque(maxlen=_LOG_LINES))
    told: str = ""
    """What came of the last key."""

    def hear(self, event: Published | Gap) -> None:
        """Take what happened."""
        match event:
            case MapChanged():
                self._map(event)
            case Status():
                self.status = event
            case PoseEstimate():
                self.pose = event
                if event.final and event.best is not None and event.bearings_rad:  # the sweep itself has said where
                    self.taken_at = event.best
            case MissionProgress():
                self.mission = event
            case SweepBegun() | SweepReadings() | SweepProgress() | SweepDone():
                self._sweep(event)
            case LogEntry():
                self.log.append(event)

    def _sweep(self, event: SweepBegun | SweepReadings | SweepProgress | SweepDone) -> None:
        match event:
            case SweepBegun():
                self.readings, self.taken_at = [], event.in_map
            case SweepReadings():
                self.readings += from_columns(event)
            case SweepProgress():
                self.sweep = event
            case SweepDone():
                self.readings, self.taken_at = list(event.sweep.readings), event.in_map

    def show(self, width: int, height: int, ink: Ink, *, with_map: bool) -> RenderableType:
        """Return all of it, as wide and as high as there is room."""
        lines = Text("\n").join([Text(line, overflow="ellipsis", no_wrap=True) for line in self._lines()])
        if not with_map:
            return lines
        # Two cells are one line; what stands below the map, and the axis, need theirs.
        room = max(4, height - len(self._lines()) - 2)
        return Group(self._drawn(width, room, ink), lines)

    def _map(self, event: MapChanged) -> None:
        if event.whole:
            self.taken_at = None  # places of another map are none of this one
        if event.map_id is None:
            self.spec, self.values = None, None
        elif event.whole:
            self.spec, self.values = event.spec, event.values.copy()
        elif self.values is not None and self.values.size > (event.cells.max(initial=0)):
            self.values.reshape(-1)[event.cells] = event.values

    def _drawn(self, width: int, room: int, ink: Ink) -> Text:
        if self.spec is None or self.values is None:
            return Text("no map is in use: robotctl map start NAME, or robotctl map load NAME")
        shrunk = shrink(self.spec, self.values, width)
        while shrunk.cells.shape[0] // 2 > room and width > 12:
            width = max(12, math.floor(width * 0.9))
            shrunk = shrink(self.spec, self.values, width)
        pose = self.pose
        robot = pose.best if pose is not None else None
        places_m = [] if pose is None or robot is not None else [(one.pose.x_m, one.pose.y_m) for one in pose.regions]
        return draw(shrunk, ink, robot=robot, places_m=places_m, hits_m=self._hits_m())

    def _hits_m(self) -> list[tuple[float, float]]:
        """Return where the readings of the sweep met something, on the map, if it is known where it is taken."""
        if self.taken_at is None:
            return []
        hits = [reading for reading in self.readings if reading.status is ReadingStatus.OK]
        return [
            self.taken_at.transform(
                reading.origin_x_m + (reading.range_m or 0.0) * math.cos(reading.bearing_rad),
                reading.origin_y_m + (reading.range_m or 0.0) * math.sin(reading.bearing_rad),
            )
            for reading in hits
        ]

    def _lines(self) -> list[str]:
        """Return what is said below the map, a line each."""
        lines = [KEYS + (f"   {self.told}" if self.told else "")]
        if self.status is not None:
            status = self.status
            links = ", ".join(
                f"{one.name} {one.link}{' armed' if one.armed else ''}{''.join(f' {fault}!' for fault in one.faults)}"
                for one in status.devices
            )
            battery = "" if status.battery_v is None else f", battery {status.battery_v:.1f} V"
            held = f", held: {status.held}" if status.held else ""
            lines += [f"{status.mode}: {status.reason}{held}{battery}", links]
        if self.pose is not None:
            lines.append(estimate_in_words(self.pose))
        if self.mission is not None:
            lines.append(mission_in_words(self.mission))
        if self.sweep is not None:
            taken = f"sweep {self.sweep.number}: {self.sweep.taken}/{self.sweep.total}"
            lines.append(f"{taken}, {counts_in_words(self.sweep)}")
        return [*lines, *map(_log_line, self.log)]


def _log_line(entry: LogEntry) -> str:
    """Return the first line of what was logged."""
    return f"{entry.level.lower()} {entry.message.partition(chr(10))[0]}"
