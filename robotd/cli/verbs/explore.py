"""``explore``: map a place without being told where to stop."""

import argparse

from robotd.cli.exit_codes import AMBIGUOUS, LOST, OK
from robotd.cli.motion import MissionOutcome, carry_out, mission_verb
from robotd.cli.quantities import number, positive, whole
from robotd.cli.show.wording import as_json, ending_in_words
from robotd.cli.verbs.map_making import map_name, pose_argument, stops_argument, taken_up, tilts_argument, tilts_named
from robotd.client.mission_run import MissionEvent
from robotd.contract.area import Bounds
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore
from robotd.core.pose import IDENTITY

_S_PER_MINUTE = 60.0


def _explore(arguments: argparse.Namespace) -> int:
    if arguments.resume and (code := taken_up(arguments)) != OK:
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
        tilts=tilts_named(arguments.tilt),
    )
    return carry_out(arguments, mission, _explored)


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
    tilts_argument(parser)


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
