"""``drive``, ``turn``, ``look`` and ``scan``: the robot moved by hand, so to speak. No map is needed or looked at."""

import argparse
import math

from robotd.cli.motion import carry_out
from robotd.cli.quantities import between
from robotd.cli.verb import Verb
from robotd.contract.missions import DriveStraight, Look, Scan, Turn

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


def _scan(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, Scan())


VERBS = (
    Verb(
        "drive",
        "drive straight ahead, or back, by odometry; needs no map",
        "robotctl drive 0.5",
        _drive,
        _distance,
        asks_daemon=True,
    ),
    Verb(
        "turn",
        "turn on the spot by odometry; needs no map",
        "robotctl turn -90",
        _turn,
        _angle,
        asks_daemon=True,
    ),
    Verb("look", "point the head", "robotctl look 30 -10", _look, _direction, asks_daemon=True),
    Verb(
        "scan",
        "take one sweep where it stands, without a map",
        "robotctl scan --json",
        _scan,
        asks_daemon=True,
    ),
)
