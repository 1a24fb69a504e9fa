"""``drive``, ``turn``, ``look``, ``measure`` and ``scan``: the robot moved by hand, so to speak; no map is needed."""

import argparse
import math
from functools import partial

from robotd.cli.motion import MissionOutcome, carry_out, last_word, mission_verb
from robotd.cli.quantities import between, whole
from robotd.cli.show.terminal import out
from robotd.cli.show.wording import as_json, range_in_words
from robotd.client.mission_run import MissionEvent, ranges_measured
from robotd.contract.events import SweepDone
from robotd.contract.missions import DriveStraight, Look, Measure, Scan, Turn

_FARTHEST_M = 10.0
_FARTHEST_DEG = 3600.0


def _drive(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, DriveStraight(arguments.distance_m))


def _distance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "distance_m",
        type=between(-_FARTHEST_M, _FARTHEST_M, "m"),
        metavar="METRES",
        help=f"how far, negative is back, at most {_FARTHEST_M:g} [m]; nothing but its bumpers sees what is in the way",
    )


def _turn(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, Turn(math.radians(arguments.angle_deg)))


def _angle(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "angle_deg",
        type=between(-_FARTHEST_DEG, _FARTHEST_DEG, "degrees"),
        metavar="DEGREES",
        help=f"how far, counter-clockwise, negative is clockwise, at most {_FARTHEST_DEG:g} [degrees]",
    )


def _look(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, Look(math.radians(arguments.pan_deg), math.radians(arguments.tilt_deg)))


def _direction(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "pan_deg", type=between(-360.0, 360.0, "degrees"), metavar="PAN", help="counter-clockwise from ahead [degrees]"
    )
    parser.add_argument(
        "tilt_deg", type=between(-360.0, 360.0, "degrees"), metavar="TILT", help="up from level [degrees]"
    )


def _measure(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, Measure(arguments.count), _measured)


def _measured(events: list[MissionEvent]) -> MissionOutcome:
    ranges = ranges_measured(events)
    lines = [range_in_words(one) for one in ranges]
    if len(ranges) > 1:
        lines.append(last_word(events).words)
    return MissionOutcome([as_json(one) for one in ranges], "\n".join(lines))


def _count(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--count", type=whole(1, 1000), default=1, metavar="N", help="how often, at most 1000 (default: 1)"
    )


def _scan(arguments: argparse.Namespace) -> int:
    conclude = partial(_swept, with_picture=arguments.plot)
    return carry_out(arguments, Scan(base_turns=not arguments.head_only), conclude)


def _swept(events: list[MissionEvent], *, with_picture: bool) -> MissionOutcome:
    done = next(event for event in reversed(events) if isinstance(event, SweepDone))
    picture = None
    if with_picture:
        from robotd.cli.show.sweep_picture import sweep_picture  # noqa: PLC0415  # only here is a grid needed

        picture = sweep_picture(done.sweep, out())
    return MissionOutcome(as_json(done), last_word(events).words, picture=picture)


def _how_to_scan(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--head-only", action="store_true", help="leave out what the head does not reach by itself")
    parser.add_argument("--plot", action="store_true", help="draw what was seen, from above, ahead to the right")


VERBS = (
    mission_verb(
        "drive", "drive straight ahead, or back, by odometry; needs no map", "robotctl drive 0.5", _drive, _distance
    ),
    mission_verb("turn", "turn on the spot by odometry; needs no map", "robotctl turn -90", _turn, _angle),
    mission_verb("look", "point the head", "robotctl look 30 -10", _look, _direction),
    mission_verb("measure", "measure the range where the head points", "robotctl measure --count 20", _measure, _count),
    mission_verb("scan", "take one sweep where it stands, without a map", "robotctl scan --plot", _scan, _how_to_scan),
)
