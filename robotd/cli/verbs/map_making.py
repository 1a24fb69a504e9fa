"""``map start`` and ``map continue``: mapping at stops that somebody names."""

import argparse
import math
from collections.abc import Sequence

import msgspec

from robotd.cli.connection import connect
from robotd.cli.exit_codes import AMBIGUOUS, LOST, OK
from robotd.cli.motion import carry_out, legs_argument, mission_verb
from robotd.cli.quantities import heading_of_deg, number
from robotd.cli.show.terminal import err
from robotd.cli.verbs.where import found_in_words
from robotd.cli.wheels import odometry_argument
from robotd.contract.answers import ErrorCode
from robotd.contract.arguments import MapName, TiltArgument
from robotd.contract.estimate import PoseEstimate
from robotd.contract.missions import Legs, Localize, MapContinue, MapStart, PriorHeading
from robotd.contract.topics import Topic
from robotd.core.errors import MapError, ServerError
from robotd.core.pose import IDENTITY, Pose2

_PATIENCE_S = 3.0
"""How long to wait for the pose, which is told on joining."""


def _start(arguments: argparse.Namespace) -> int:
    if arguments.discard:
        _give_up(arguments)
    start, stops_m = arguments.start, tuple(map(tuple, arguments.stop))
    if arguments.world is not None:
        from robotd.sim.load import load_robot  # noqa: PLC0415  # no other verb here needs a simulation
        from robotd.sim.recorded_robot import OdometrySource  # noqa: PLC0415  # as above

        robot = load_robot(arguments.world, odometry=OdometrySource(arguments.odometry))
        start, stops_m = start or robot.start, stops_m or robot.stops_m
    legs = Legs(arguments.legs)
    return carry_out(
        arguments, MapStart.of(arguments.name, stops_m, start or IDENTITY, legs, tilts_named(arguments.tilt))
    )


def _give_up(arguments: argparse.Namespace) -> None:
    with connect(arguments) as client:
        try:
            client.map_discard()
        except ServerError as error:
            if error.code != ErrorCode.NOT_FOUND:
                raise  # where no map is in use, there is nothing to give up


def _start_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", type=map_name, help="what to call the map")
    stops_argument(
        parser, "where to stop and sweep [m], once for each; the robot's place at the start comes first by itself"
    )
    pose_argument(parser, "--start", "where the robot stands now, which fixes the map's axes (default: 0 0 0)")
    parser.add_argument("--world", metavar="WORLD", help="take start and stops from a world of robotctl sim")
    odometry_argument(parser)
    legs_argument(parser)
    tilts_argument(parser)
    parser.add_argument(
        "--discard",
        action="store_true",
        help="give up what nobody saved of the map in use, which else is kept first, and in the way if it cannot be",
    )


def _continue(arguments: argparse.Namespace) -> int:
    if (code := taken_up(arguments, looks=arguments.robot is None)) != OK:
        return code
    stops_m = tuple(map(tuple, arguments.stop))
    return carry_out(arguments, MapContinue.of(arguments.name, stops_m, arguments.robot, Legs(arguments.legs)))


def _continue_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", type=map_name, help="the map: the one in use, or the newest of that name in the store")
    stops_argument(
        parser, "where to stop and sweep [m], once for each; where the robot stands now comes first by itself"
    )
    pose_argument(parser, "--robot", "where the robot stands on it, if you know (default: as it is localized)")
    legs_argument(parser)


def taken_up(arguments: argparse.Namespace, *, looks: bool = True) -> int:
    """Take up what nobody finished: load the map if it is not in use, and find the robot on it; return the exit code.

    Without ``looks`` somebody else says where the robot is.

    Raises:
        MapError: there is no such map.
        MissionError: another mission is under way.
    """
    name = arguments.name
    with connect(arguments) as client:
        if client.status().map_name != name:
            kept = [entry.version for entry in client.map_list() if entry.name == name and entry.damage is None]
            if not kept:
                raise MapError(f"no map {name} is in use or in the store, so none can be gone on with")
            # The newest, saved or not: it is what the last stop left.
            entry = client.map_load(name, max(kept), None)
            err().print(f"loaded {name} version {entry.version}, made of {entry.stops} stops")
        if not looks:
            return OK
        with client.subscribe(Topic.POSE) as events:
            pose = events.next(_PATIENCE_S)
    if isinstance(pose, PoseEstimate) and pose.best is not None:
        return OK
    err().print("it is not known where the robot is on it: it looks round first")
    return carry_out(arguments, Localize(heading=PriorHeading.UNKNOWN), found_in_words)


def map_name(text: str) -> str:
    """Return the name of a map, as it may be."""
    try:
        return msgspec.convert(text, MapName)
    except msgspec.ValidationError:
        allowed = "1 to 64 letters, digits, '.', '-' and '_', the first a letter or a digit"
        raise argparse.ArgumentTypeError(f"{text!r} is no name for a map, which has {allowed}") from None


class _PoseAction(argparse.Action):
    """Turns ``X Y DEG`` into a pose."""

    def __call__(self, parser: object, namespace: argparse.Namespace, values: object, _: object = None) -> None:
        assert isinstance(values, list)
        x_m, y_m, heading_deg = values
        setattr(namespace, self.dest, Pose2(x_m, y_m, heading_of_deg(heading_deg)))


def pose_argument(parser: argparse.ArgumentParser, name: str, summary: str) -> None:
    """Let the command line name a pose, ``X Y DEG``."""
    parser.add_argument(name, action=_PoseAction, nargs=3, type=number, metavar=("X", "Y", "DEG"), help=summary)


def stops_argument(parser: argparse.ArgumentParser, summary: str) -> None:
    """Let the command line name stops, ``--stop X Y`` once for each."""
    parser.add_argument("--stop", action="append", nargs=2, type=number, default=[], metavar=("X", "Y"), help=summary)


def tilts_argument(parser: argparse.ArgumentParser) -> None:
    """Let the command line name further tilts, ``--tilt DEG CUT_OFF`` once for each."""
    parser.add_argument(
        "--tilt",
        action="append",
        nargs=2,
        type=number,
        default=[],
        metavar=("DEG", "CUT_OFF"),
        help="look round at this tilt as well, up from level [degrees], for a layer of the map of its own, and take"
        " what is farther than the cut-off [m] for not met: before the floor; once for each",
    )


def tilts_named(named: Sequence[Sequence[float]]) -> tuple[TiltArgument, ...]:
    """Return the tilts that the command line names."""
    return tuple(TiltArgument(math.radians(tilt_deg), cut_off_m) for tilt_deg, cut_off_m in named)


VERBS = (
    mission_verb(
        "map start",
        "make a new map, stop by stop",
        "robotctl map start kitchen --stop 1.5 0 --stop 1.5 2",
        _start,
        _start_arguments,
    ),
    mission_verb(
        "map continue",
        "go on with a map, stop by stop: the one in use, or a stored one",
        "robotctl map continue kitchen --stop 3 0 --stop 3 2",
        _continue,
        _continue_arguments,
        exit_codes=((LOST, "lost: it did not find itself on the map"), (AMBIGUOUS, "ambiguous: at several places")),
    ),
)
