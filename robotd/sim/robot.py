"""A whole robot behind three boards: the simulated one, and what every emulated one offers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from robotd.core.errors import ConfigError
from robotd.core.pose import Pose2
from robotd.sim.buildings.world import World
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.hosting.board_clock import BoardClock, DriveOnClock, HeadOnClock, LaserOnClock
from robotd.sim.hosting.host import HostedBoard
from robotd.sim.physics.body import Body, BodySettings
from robotd.sim.physics.laser import Laser, LaserSettings
from robotd.sim.physics.noise import NoiseSettings, stream
from robotd.sim.physics.plant import DrivePlant, HeadPlant, ScannerPlant
from robotd.sim.physics.steppers import StepperHead, StepperSettings
from robotd.sim.physics.walls import Point, clearance_m

DEVICES = ("drive", "pantilt", "rangefinder")


class EmulatedRobot(Protocol):
    """Three boards, the place they believe to be in, and the truth about it."""

    start: Pose2
    """Where the robot stands at first; it ties the frame of ``stops_m`` to odometry."""
    stops_m: tuple[Point, ...]
    """Where to stop for a map, after the start."""
    probes_m: tuple[Point, ...]
    """Where to localize afterwards."""

    @property
    def boards(self) -> Mapping[str, HostedBoard]:
        """By device name."""

    @property
    def clocks(self) -> Mapping[str, BoardClock]:
        """The boards' own clocks, by device name."""

    @property
    def truth(self) -> Pose2:
        """Where it really is, as of the last advance of a board."""

    @property
    def at_rest(self) -> bool:
        """Whether it stands, and nobody asks it to move."""


@dataclass(frozen=True, slots=True)
class SimSettings:
    """Everything about the simulated hardware."""

    noise: NoiseSettings = field(default_factory=NoiseSettings)
    body: BodySettings = field(default_factory=BodySettings)
    head: StepperSettings = field(default_factory=StepperSettings)
    laser: LaserSettings = field(default_factory=LaserSettings)


class SimulatedRobot:
    """Physics in a world. The same seed gives the same robot, noise and clocks, no matter who asks what when.

    Raises:
        ConfigError: the robot does not fit where the world wants it to start.
    """

    def __init__(
        self,
        world: World,
        seed: int = 0,
        settings: SimSettings | None = None,
        *,
        boot: int = 0,
        dialects: Dialects | None = None,
    ) -> None:
        """Put the robot at the start; ``boot`` counts how often its boards were powered up before."""
        settings = settings or SimSettings()
        noise = settings.noise
        self.start = world.start_pose
        self.stops_m = world.stops_m
        self.probes_m = world.probes_m
        if clearance_m(world.walls, (self.start.x_m, self.start.y_m)) < settings.body.radius_m:
            raise ConfigError(f"a robot of radius {settings.body.radius_m} m does not fit there", key="start")
        self._body = Body(world.walls, self.start, settings.body, noise, stream(seed, "drive"))
        self._head = StepperHead(settings.head)
        self._laser = Laser(
            world.walls,
            self._body,
            self._head,
            settings=settings.laser,
            noise=noise,
            randomness=stream(seed, "rangefinder"),
        )
        self.clocks = clocks_of_seed(seed, noise.clock_skew_ppm)
        self.boards = board_by_device(
            self._body,
            self._head,
            self._laser,
            clocks=self.clocks,
            seed=seed,
            boot=boot,
            dialects=dialects or Dialects(),
        )

    @property
    def truth(self) -> Pose2:
        """Where it really is, as of the last advance of a board."""
        return self._body.true_pose

    @property
    def at_rest(self) -> bool:
        """Whether it stands, and nobody asks it to move."""
        return self._body.at_rest


def clocks_of_seed(seed: int, skew_ppm: float) -> dict[str, BoardClock]:
    """Draw a clock for each device."""
    return {device: BoardClock.of_seed(seed, device, skew_ppm) for device in DEVICES}


def board_by_device(
    drive: DrivePlant,
    head: HeadPlant,
    laser: ScannerPlant,
    *,
    clocks: dict[str, BoardClock],
    seed: int,
    boot: int,
    dialects: Dialects,
) -> dict[str, HostedBoard]:
    """Put a board on top of each plant, each with a clock and a boot id of its own."""
    # Another with each boot, as PROTOCOL.md demands, and yet the same in each run.
    boot_ids = {device: stream(seed, f"{device}/boot {boot}").getrandbits(32) for device in DEVICES}
    return {
        "drive": dialects.drive_on(DriveOnClock(drive, clocks["drive"]), boot_ids["drive"]),
        "pantilt": dialects.pantilt_on(HeadOnClock(head, clocks["pantilt"]), boot_ids["pantilt"]),
        "rangefinder": dialects.rangefinder_on(LaserOnClock(laser, clocks["rangefinder"]), boot_ids["rangefinder"]),
    }
