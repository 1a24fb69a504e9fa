"""A robot whose laser answers come from the scans of a real log, at that log's poses.

The body drives as it is told, without slip and without walls. Where it comes to rest within 0.15 m of a stop, the
scan taken there answers: a beam's recorded end point, seen from where the body now stands, so that body, odometry
and readings always fit each other. (Odometry comes out of two encoders and cannot jump sideways onto the recorded
pose; the daemon stops within a few centimetres of it, and that little is taken into account beam by beam.)

The head has no inertia. It rests only on directions in which the scanner had a beam, and says so in its readback;
aimed elsewhere it stays as aimed, and the laser answers that it cannot see there.
"""

import enum
import math

from firmware_proto.common import Fault
from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.pose import Pose2
from robotd.sim.buildings.building import RecordedBuilding, View, view_from
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.physics.body import Body, BodySettings
from robotd.sim.physics.noise import NOISELESS, stream
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.physics.walls import NO_WALLS, Point
from robotd.sim.robot import board_by_device, clocks_of_seed

AT_STOP_M = 0.15
"""The daemon stops within a few centimetres; what was seen from farther off may be hidden from here."""
_CLOCK_SKEW_PPM = 40.0
_BRISK = BodySettings(acceleration_mps2=3.0, turn_acceleration_radps2=15.0, speed_max_mps=3.0, turn_max_radps=6.0)
"""Quicker than any robot: nothing is measured on the way, it is only waited for."""
_SHOT_US = 1_000
_STRENGTH = 1_000
_AIMED_WELL_RAD = 1e-9
"""A head that rests on a beam points at it exactly, but for rounding."""


class OdometrySource(enum.StrEnum):
    """What the wheels report from stop to stop."""

    CORRECTED = "corrected"
    """The log's corrected poses: odometry without error."""
    RAW = "raw"
    """What the robot's own odometry made of it."""


class Place:
    """Which stop the body is at, and what is seen from there."""

    def __init__(self, building: RecordedBuilding, odometry: OdometrySource) -> None:
        first = building.stops[0]
        # Raw odometry has a frame of its own: it is laid so that both agree at the first stop.
        tie = Pose2(0.0, 0.0, 0.0) if odometry is OdometrySource.CORRECTED else first.pose @ first.odometry.inverse()
        self._stops = tuple(
            (stop, stop.pose if odometry is OdometrySource.CORRECTED else tie @ stop.odometry)
            for stop in building.stops
        )
        self.body = Body(NO_WALLS, self._stops[0][1], _BRISK, NOISELESS, stream(0, "drive"))
        self._stop, self._stop_at = self._stops[0]
        self._told_from: Pose2 | None = None
        self._view: View | None = None

    def points_m(self, *, kept_out: bool) -> tuple[Point, ...]:
        """Return where the stops are for the body's odometry, those of the map or those kept out of it."""
        return tuple((at.x_m, at.y_m) for stop, at in self._stops if stop.kept_out is kept_out)

    @property
    def truth(self) -> Pose2:
        """Where the body is in the log's own frame, told from the nearest stop."""
        in_stop = self._in_stop()
        return self._stop.pose @ in_stop

    def view(self) -> View | None:
        """Return what is seen from here; None unless the body rests at a stop."""
        in_stop = self._in_stop()
        if not self.body.at_rest or math.hypot(in_stop.x_m, in_stop.y_m) > AT_STOP_M:
            return None
        if self._view is None:
            self._view = view_from(self._stop, in_stop)
        return self._view

    def _in_stop(self) -> Pose2:
        """Return where the body is in the frame of the recorded robot at the nearest stop."""
        here = self.body.true_pose
        if here != self._told_from:  # a sweep asks hundreds of times from one place
            self._stop, self._stop_at = min(self._stops, key=lambda pair: pair[1].distance_m(here))
            self._told_from, self._view = here, None
        return self._stop_at.inverse() @ here


class RecordedHead:
    """A head that can only look where the scanner looked."""

    def __init__(self, place: Place) -> None:
        self.limits_rad = (-math.pi, math.pi, 0.0, 0.0)
        self.broken = Fault.NONE
        self._place = place
        self._angles_rad = (0.0, 0.0)

    def advance(self, to_us: int) -> None:
        """Let time pass; the head does not need any."""
        self._place.body.advance(to_us)

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        """Point at the beam nearest to there."""
        view = self._place.view()
        beam = None if view is None else view.nearest(pan_rad)
        if view is not None and beam is not None:
            pan_rad = float(view.bearings_rad[beam])
        self._angles_rad = (pan_rad, tilt_rad)

    def halt(self) -> None:
        """Stay; it never is on its way."""

    @property
    def angles_rad(self) -> tuple[float, float]:
        """Where it points."""
        return self._angles_rad

    @property
    def arrives_us(self) -> int | None:
        """It is always there already."""
        return None


class RecordedLaser:
    """A laser that gives the recorded range of the beam that the head rests on."""

    def __init__(self, place: Place, head: RecordedHead) -> None:
        self._place = place
        self._head = head
        self._on = False

    def switch(self, *, on: bool) -> None:
        """Switch the light."""
        self._on = on

    def shoot(self, at_us: int) -> ShotAnswer:
        """Answer from the scan of the stop."""
        return self.measure(at_us, self._head.angles_rad[0])

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        """Answer from the scan of the stop, wherever the head points."""
        self._place.body.advance(at_us)
        if not self._on:
            return ShotAnswer(ShotStatus.LASER_OFF, 0.0, 0, _SHOT_US)
        range_m = self._recorded_m(pan_rad)
        if range_m is None:  # no beam went there: not a miss, which would clear cells
            return ShotAnswer(ShotStatus.NOT_MEASURED, 0.0, 0, _SHOT_US)
        if math.isinf(range_m):
            return ShotAnswer(ShotStatus.OVER_RANGE, 0.0, 0, _SHOT_US)
        return ShotAnswer(ShotStatus.OK, range_m, _STRENGTH, _SHOT_US)

    def _recorded_m(self, pan_rad: float) -> float | None:
        view = self._place.view()
        beam = None if view is None else view.nearest(pan_rad)
        if view is None or beam is None:
            return None
        missed_by_rad = math.remainder(view.bearings_rad[beam] - pan_rad, math.tau)
        return float(view.ranges_m[beam]) if abs(missed_by_rad) <= _AIMED_WELL_RAD else None


class RecordedRobot:
    """An emulated robot in a recorded building; see :class:`robotd.sim.robot.EmulatedRobot`."""

    def __init__(
        self,
        building: RecordedBuilding,
        seed: int = 0,
        *,
        odometry: OdometrySource = OdometrySource.CORRECTED,
        boot: int = 0,
        dialects: Dialects | None = None,
    ) -> None:
        """Put the robot at the first stop; ``seed`` draws the boards' clocks, nothing else is random."""
        self._place = Place(building, odometry)
        self.start = self._place.body.true_pose
        self.stops_m = self._place.points_m(kept_out=False)[1:]
        self.probes_m = self._place.points_m(kept_out=True)
        head = RecordedHead(self._place)
        laser = RecordedLaser(self._place, head)
        self.clocks = clocks_of_seed(seed, _CLOCK_SKEW_PPM)
        self.boards = board_by_device(
            self._place.body, head, laser, clocks=self.clocks, seed=seed, boot=boot, dialects=dialects or Dialects()
        )

    @property
    def truth(self) -> Pose2:
        """Where it is in the log's frame, as of the last advance of a board."""
        return self._place.truth

    @property
    def at_rest(self) -> bool:
        """Whether it stands, and nobody asks it to move."""
        return self._place.body.at_rest
