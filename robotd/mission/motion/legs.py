"""Turning, driving and standing still, advanced by each odometry message and by nothing else.

A set-point goes out for every odometry message that comes in, so a line that falls silent takes the
set-points with it and the base's own deadman does the rest. Anyone who calls these must stop the robot when they raise
or are cancelled: a stop is the supervisor's, and the last word. Because no timer decides anything but how long
silence may last, the same bytes always lead to the same motion: replay depends on it.
"""

import math
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager

from robotd.core.angles import wrap_rad
from robotd.core.broadcast import Subscription
from robotd.core.clock import NS_PER_S
from robotd.core.errors import DeviceError
from robotd.core.pose import STANDSTILL, Odometry, Pose2, Twist2
from robotd.core.silence import Silence, within
from robotd.hardware.devices.drive import Drive
from robotd.mission.motion.steering import DrivingSettings, distance_left_m, leg_twist, turn_rate_radps
from robotd.mission.safety.hold import FellSilent, Hold, Interrupted

_ABOUT_FACE = Pose2(0.0, 0.0, math.pi)
"""Who goes backwards steers as one who looks back and goes ahead."""


async def rotate_to(drive: Drive, heading_rad: float, settings: DrivingSettings, hold: Hold | None = None) -> Odometry:
    """Turn on the spot to a heading in the ``odom`` frame, the short way round.

    Raises:
        FellSilent: odometry fell silent.
        DeviceError: the base does not turn.
        Interrupted: the mission was held meanwhile.
    """

    def error_rad(now: Odometry) -> float:
        return wrap_rad(heading_rad - now.in_odom.heading_rad)

    return await _approach(
        drive,
        settings,
        hold,
        what="turn",
        left=lambda now: abs(error_rad(now)),
        tolerance=settings.heading_tolerance_rad,
        twist=lambda now: Twist2(0.0, turn_rate_radps(error_rad(now), settings)),
    )


class TurnedSoFar:
    """How far the base has turned, as often round as it did: a heading alone goes round and forgets."""

    def __init__(self) -> None:
        self.rad = 0.0
        self._last_rad: float | None = None

    def note(self, now: Odometry) -> None:
        """Take the next odometry, less than half a turn after the last."""
        heading_rad = now.in_odom.heading_rad
        if self._last_rad is not None:
            # Summed step by step: the difference of two headings cannot tell a turn of 350 degrees from one of
            # -10.
            self.rad += wrap_rad(heading_rad - self._last_rad)
        self._last_rad = heading_rad


async def turn_by(
    drive: Drive, angle_rad: float, turned: TurnedSoFar, settings: DrivingSettings, hold: Hold | None = None
) -> Odometry:
    """Turn on the spot until ``turned`` has come to ``angle_rad``. Same errors as :func:`rotate_to`."""

    def left_rad(now: Odometry) -> float:
        turned.note(now)
        return abs(angle_rad - turned.rad)

    return await _approach(
        drive,
        settings,
        hold,
        what="turn",
        left=left_rad,
        tolerance=settings.heading_tolerance_rad,
        twist=lambda _: Twist2(0.0, turn_rate_radps(angle_rad - turned.rad, settings)),
    )


async def translate_to(
    drive: Drive,
    x_m: float,
    y_m: float,
    settings: DrivingSettings,
    hold: Hold | None = None,
    *,
    backwards: bool = False,
    unless: Callable[[], bool] = lambda: False,
) -> Odometry:
    """Drive straight to a point in the ``odom`` frame that lies ahead, or behind if it is to go ``backwards``.

    Once ``unless`` is true it comes to a stand where it is.

    Raises:
        FellSilent: odometry fell silent.
        DeviceError: the base does not get nearer.
        Interrupted: the mission was held meanwhile.
    """

    # One law for both ways: a second one for going backwards would have signs of its own to get wrong.
    def facing(now: Odometry) -> Pose2:
        return now.in_odom @ _ABOUT_FACE if backwards else now.in_odom

    def twist(now: Odometry) -> Twist2:
        ahead = leg_twist(facing(now), x_m, y_m, settings)
        return Twist2(-ahead.speed_mps, ahead.turn_radps) if backwards else ahead

    return await _approach(
        drive,
        settings,
        hold,
        what="drive",
        # Past the end it is over, however far: no set-point turns round.
        left=lambda now: max(0.0, distance_left_m(facing(now), x_m, y_m)),
        tolerance=settings.position_tolerance_m,
        twist=twist,
        unless=unless,
    )


async def drive_leg(
    drive: Drive,
    x_m: float,
    y_m: float,
    settings: DrivingSettings,
    hold: Hold | None = None,
    *,
    unless: Callable[[], bool] = lambda: False,
) -> Odometry:
    """Drive one leg: rotate towards its end in the ``odom`` frame, then translate to it, as :func:`translate_to`."""
    # The next and not the latest: what was told before a hold, or before the base was last pushed, is no start.
    here = await next_odometry(drive, settings.silence_s)
    # From so near the bearing to the end points anywhere, and the robot would turn for nothing.
    if math.hypot(x_m - here.in_odom.x_m, y_m - here.in_odom.y_m) <= settings.position_tolerance_m:
        return here
    await rotate_to(drive, math.atan2(y_m - here.in_odom.y_m, x_m - here.in_odom.x_m), settings, hold)
    return await translate_to(drive, x_m, y_m, settings, hold, unless=unless)


async def settle(drive: Drive, settle_s: float, settings: DrivingSettings) -> Odometry:
    """Wait until odometry has reported standstill for ``settle_s`` by its own times; return the last report.

    Raises:
        FellSilent: odometry fell silent.
        DeviceError: the base does not come to rest.
    """
    began_ns: int | None = None
    since_ns: int | None = None
    with drive.odometry.subscribe() as stream:
        async for now in _within(stream, settings.silence_s):
            began_ns = now.time_ns if began_ns is None else began_ns
            if now.twist.is_zero:
                since_ns = now.time_ns if since_ns is None else since_ns
                if now.time_ns - since_ns >= settle_s * NS_PER_S:
                    return now
                continue
            # Standstill must be in one piece: a base that creeps stands still for moments.
            since_ns = None
            if now.time_ns - began_ns > settings.stall_s * NS_PER_S:
                raise DeviceError(drive.name, "restless", f"it does not stand still within {settings.stall_s:g} s")
    raise AssertionError("a subscription never ends")


async def next_odometry(drive: Drive, silence_s: float) -> Odometry:
    """Return the next odometry message; FellSilent if there is none for ``silence_s``."""
    with drive.odometry.subscribe() as stream:
        async for now in _within(stream, silence_s):
            return now
    raise AssertionError("a subscription never ends")


async def _approach(
    drive: Drive,
    settings: DrivingSettings,
    hold: Hold | None,
    *,
    what: str,
    left: Callable[[Odometry], float],
    tolerance: float,
    twist: Callable[[Odometry], Twist2],
    unless: Callable[[], bool] = lambda: False,
) -> Odometry:
    """Send ``twist`` for each odometry message until ``left`` is within ``tolerance``, or ``unless``; then stand."""
    hold = Hold() if hold is None else hold
    holds = hold.count
    nearest, nearest_ns = math.inf, 0
    with drive.odometry.subscribe() as stream, _led(hold, settings.setpoint_ttl_s) as set_points:
        async for now in _within(stream, settings.silence_s):
            # Before anything is said to the base: it was stopped for the hold, and stays so.
            if hold.count != holds:
                raise Interrupted
            remaining = left(now)
            if remaining <= tolerance or unless():
                # Said, not left to the deadman: that would let it roll on for as long as the last set-point
                # lives.
                drive.set_velocity(STANDSTILL, settings.setpoint_ttl_s)
                return now
            # Less than that is no progress: a base that creeps by ever smaller steps would put the stall off for ever.
            if remaining < nearest - tolerance / 4.0:
                # Stalls are judged by odometry's own times, so a replay finds the same one, at the same
                # message.
                nearest, nearest_ns = remaining, now.time_ns
            elif now.time_ns - nearest_ns > settings.stall_s * NS_PER_S:
                raise DeviceError(drive.name, "stalled", f"{what} is no nearer to its end for {settings.stall_s:g} s")
            drive.set_velocity(twist(now), settings.setpoint_ttl_s)
            set_points.renew()
    raise AssertionError("a subscription never ends")


@contextmanager
def _led(hold: Hold, ttl_s: float) -> Iterator[Silence]:
    """Let a hold know when no set-point was given for half the time that one lives; each renews what is yielded."""
    # Half: its clock is another than ours, and what was under way was lost with what was not said.
    silence = Silence(ttl_s / 2.0, hold.set_points_stay_away, of="set-points", begins=False)
    try:
        yield silence
    finally:
        silence.end()


async def _within(stream: Subscription[Odometry], silence_s: float) -> AsyncIterator[Odometry]:
    while True:
        try:
            async with within(silence_s, of="odometry"):
                now = await stream.get()
        # Silence of a kind of its own: a hold may wait for a base that fell silent, and for nothing else.
        except TimeoutError:
            raise FellSilent(f"drive: no odometry for {silence_s:g} s") from None
        yield now
