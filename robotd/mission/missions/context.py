"""What a mission works with, handed to it by the supervisor."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from robotd.contract.events import MissionPhase, MissionProgress, SweepDone
from robotd.core.clock import now_ns
from robotd.core.reading import Sweep, Tilt
from robotd.core.text import printable
from robotd.head.head import Head
from robotd.mission.missions.ranks_told import RanksTold
from robotd.mission.missions.settings import MissionSettings
from robotd.mission.missions.stop_and_sweep import Sweeper, SweepListener, Wants
from robotd.mission.missions.sweep_told import SweepTold
from robotd.mission.news import Publish
from robotd.mission.safety.hold import Hold
from robotd.mission.three_devices import Robot
from robotd.mission.whereabouts.whereabouts import Whereabouts
from robotd.recording.results import result_of

_LONGEST_MESSAGE = 500
"""Letters: it may quote what a device said, and that has no end of its own."""


@dataclass(slots=True)
class Reporter:
    """Tells the world how one mission gets on, and remembers at which stop it is."""

    mission_id: int
    kind: str
    stops: int
    publish: Publish
    advise: Callable[[MissionProgress], MissionProgress] = lambda last: last
    """Adds to the last word what people should do now: for the world, not for the journal, which does not know what is
    saved."""
    stop: int = 0

    def at(self, phase: MissionPhase, stop: int | None = None, message: str = "") -> None:
        """Report a step of the mission, at the same stop as the last unless another is named."""
        self.stop = self.stop if stop is None else stop
        words = printable(message, _LONGEST_MESSAGE)
        step = MissionProgress(now_ns(), self.mission_id, self.kind, phase, self.stop, self.stops, words)
        self.publish(self.advise(step), result_of(step))


@dataclass(frozen=True, slots=True)
class MissionContext:
    """Robot, settings, who does array work, ear of the world, and where the robot is on which map."""

    robot: Robot
    settings: MissionSettings
    head: Head
    publish: Publish
    whereabouts: Whereabouts = field(default_factory=Whereabouts)
    hold: Hold = field(default_factory=Hold)
    sweep_numbers: Iterator[int] = field(default_factory=itertools.count)
    """The next sweep's number is drawn where an attempt at one begins: odd ones go round the other way, so a sweep that
    was given up counts, and a replay counts it too."""
    ranks: RanksTold = field(init=False)

    def __post_init__(self) -> None:
        """Let who looks on have pictures by the same head."""
        # The one way to fill a field of a frozen object that is made of its other fields.
        object.__setattr__(self, "ranks", RanksTold(self.head, self.publish))

    @property
    def sweeper(self) -> Sweeper:
        """Takes sweeps with this robot."""
        settings = self.settings
        # Made when asked for: it has no state of its own, so nothing of one sweep can leak into the next.
        return Sweeper(
            self.robot, settings.head_mount, settings.rangefinder, settings.sweep, settings.driving, self.hold
        )

    async def sweep(
        self, number: int, *listeners: SweepListener, base_turns: bool = True, tilts: Sequence[Tilt] = ()
    ) -> Sweep:
        """Take a sweep and publish how it goes; arguments as of :meth:`Sweeper.sweep`."""
        told = self._told(number)
        return self._done(await self.sweeper.sweep(number, told, *listeners, base_turns=base_turns, tilts=tilts))

    async def look(self, number: int, wants: Wants, *listeners: SweepListener) -> Sweep:
        """Take as much of a sweep as is wanted, published as a sweep is; arguments as of :meth:`Sweeper.look`."""
        return self._done(await self.sweeper.look(number, wants, self._told(number), *listeners))

    def _told(self, number: int) -> SweepTold:
        return SweepTold(number, self.settings.sweep.readings, self.publish, self.whereabouts.in_map)

    def _done(self, sweep: Sweep) -> Sweep:
        self.publish(SweepDone(now_ns(), sweep, self.whereabouts.in_map(sweep.in_odom)))
        return sweep
