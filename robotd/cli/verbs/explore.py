"""``explore``: map a place without being told where to stop."""

import argparse

from robotd.cli.connection import connect
from robotd.cli.exit_codes import AMBIGUOUS, LOST, OK
from robotd.cli.motion import MissionOutcome, carry_out, mission_verb
from robotd.cli.quantities import number, positive, whole
from robotd.cli.show.terminal import err
from robotd.cli.show.wording import as_json, ending_in_words
from robotd.cli.verbs.maps import map_name, pose_argument, stops_argument
from robotd.cli.verbs.where import found_in_words
from robotd.client.mission_run import MissionEvent
from robotd.contract.area import Bounds
from robotd.contract.estimate import PoseEstimate
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore, Localize, PriorHeading
from robotd.contract.topics import Topic
from robotd.core.errors import MapError
from robotd.core.pose import IDENTITY

_S_PER_MINUTE = 60.0
_PATIENCE_S = 3.0
"""How long to wait for the pose, which is told on joining."""


def _explore(arguments: argparse.Namespace) -> int:
    if arguments.resume and (code := _taken_up(arguments)) != OK:
        return code
    mission = Explore.of(
        arguments.name,
        arguments.start or IDENTITY,
        resume=arguments.resume,
        within=arguments.bounds,
        stops_m=tuple(map(tuple, arguments.stop)),
        stops_max=arguments.stops_max,
        way_max_m=arguments.way_max,
        time_max_s=None if arguments.minutes is None else arguments.minutes * _S_PER_MINUTE,
        returns=arguments.back,
    )
    return carry_out(arguments, mission, _explored)


def _taken_up(arguments: argparse.Namespace) -> int:
    """Take up what nobody finished: load the map if it is not in use, and find the robot on it; return the exit code.

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
        with client.subscribe(Topic.POSE) as events:
            pose = events.next(_PATIENCE_S)
    if isinstance(pose, PoseEstimate) and pose.best is not None:
        return OK
    err().print("it is not known where the robot is on it: it looks round first")
    return carry_out(arguments, Localize(heading=PriorHeading.UNKNOWN), found_in_words)


def _explored(events: list[MissionEvent]) -> MissionOutcome:
    ended = next(event for event in reversed(events) if isinstance(event, ExploringEnded))
    words = f"{ending_in_words(ended)}\nthe map is not saved yet: robotctl map save"
    return MissionOutcome(as_json(ended), words, LOST if ended.ending == "lost" else OK)


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", type=map_name, help="what to call the map, or with --resume, the map to go on with")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on with a map that nobody finished: the one in use, or the newest of that name in the store",
    )
    pose_argument(parser, "--start", "where the robot stands now, which fixes the map's axes (default: 0 0 0)")
    parser.add_argument(
        "--bounds",
        action=_BoundsAction,
        nargs=4,
        type=number,
        metavar=("WEST", "SOUTH", "EAST", "NORTH"),
        help="the rectangle of the map to explore [m] (default: 20 m to all sides of the start)",
    )
    stops_argument(parser, "where to stop first [m], once for each; after that it chooses for itself")
    parser.add_argument(
        "--stops-max", type=whole(1, 1000), default=100, metavar="N", help="no more stops than this (default: 100)"
    )
    parser.add_argument("--way-max", type=positive, metavar="M", help="no further stop after so long a way [m]")
    parser.add_argument("--minutes", type=positive, metavar="MIN", help="no further stop after this time")
    parser.add_argument("--return", action="store_true", dest="back", help="drive back to where it began, in the end")


class _BoundsAction(argparse.Action):
    """Turns ``WEST SOUTH EAST NORTH`` into a rectangle of the map."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: object, _: object = None
    ) -> None:
        assert isinstance(values, list)
        try:
            setattr(namespace, self.dest, Bounds(*values))
        except ValueError as error:
            parser.error(f"argument --bounds: {error}")


VERBS = (
    mission_verb(
        "explore",
        "map a place without being told where to stop",
        "robotctl explore kitchen --bounds -1 -1 6 4 --return",
        _explore,
        _arguments,
        exit_codes=(
            (LOST, "lost: sweep after sweep spoke against the map, or with --resume it did not find itself on it"),
            (AMBIGUOUS, "ambiguous: with --resume it may be at several places of it"),
        ),
    ),
)
