"""``drive`` and ``turn``: the robot moved by hand, so to speak. No map is needed, and none is looked at."""

import argparse
import math

from robotd.cli.motion import carry_out
from robotd.cli.quantities import between
from robotd.cli.verb import Verb
from robotd.contract.missions import DriveStraight, Turn

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
)
