"""``localize``, ``resolve``, ``pose``, ``watch``, ``plan`` and ``drive-to``."""

import argparse
from dataclasses import asdict
from datetime import datetime

import msgspec

from robotd.cli.connection import connect
from robotd.cli.exit_codes import AMBIGUOUS, FAILED, LOST, OK
from robotd.cli.motion import MissionOutcome, carry_out, legs_argument, mission_verb
from robotd.cli.quantities import heading_of_deg, number
from robotd.cli.show.quiet import Quiet
from robotd.cli.show.terminal import out, print_json
from robotd.cli.show.wording import as_json, estimate_in_words, in_words, odometry_in_words, region_in_words
from robotd.cli.verb import Verb
from robotd.client.feed import Gap
from robotd.client.mission_run import MissionEvent, final_estimate
from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.missions import DriveTo, Legs, Localize, PriorHeading, Resolve
from robotd.contract.topics import Published, Topic
from robotd.core.clock import NS_PER_S
from robotd.core.errors import RequestTimeout
from robotd.core.pose import Odometry

_NEWS = tuple(topic for topic in Topic if topic is not Topic.ODOMETRY)
_PATIENCE_S = 3.0
"""How long to wait for what is published on joining, unless told otherwise."""


def _localize(arguments: argparse.Namespace) -> int:
    heading_rad = None if arguments.heading_deg is None else heading_of_deg(arguments.heading_deg)
    heading = PriorHeading.UNKNOWN if arguments.heading_unknown else PriorHeading.ODOMETRY
    localize = Localize(
        heading_rad,
        heading=heading,
        within=arguments.within,
        adaptive=arguments.adaptive,
        smallest_error=arguments.smallest_error,
        layers=arguments.layers,
    )
    return carry_out(arguments, localize, found_in_words)


def _resolve(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, Resolve(within=arguments.within), found_in_words)


def found_in_words(events: list[MissionEvent]) -> MissionOutcome:
    """Conclude with where the robot was found."""
    estimate = final_estimate(events)
    # Lost and ambiguous are answers, not failures: scripts tell them apart by the exit code.
    code = {PoseState.LOST: LOST, PoseState.AMBIGUOUS: AMBIGUOUS}.get(estimate.state, OK)
    return MissionOutcome(as_json(estimate), estimate_in_words(estimate), code)


def _known(parser: argparse.ArgumentParser) -> None:
    headings = parser.add_mutually_exclusive_group()
    headings.add_argument(
        "--heading-deg",
        type=number,
        metavar="DEG",
        help="the robot's heading on the map, if you know it better than its odometry",
    )
    headings.add_argument("--heading-unknown", action="store_true", help="try all headings: it is not known")
    looks = parser.add_mutually_exclusive_group()
    looks.add_argument(
        "--adaptive",
        action="store_true",
        help="read to all sides until two answers agree, instead of a whole sweep: some twenty readings of 300",
    )
    looks.add_argument(
        "--layers",
        action="store_true",
        help="look at the tilt of each layer of the map, too: a place must then agree with each of them",
    )
    parser.add_argument(
        "--smallest-error",
        action="store_true",
        help="say, too, how far ranges must be trusted so that nine of ten agree on one pose",
    )
    _within(parser)


def _within(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--within",
        action=_AreaAction,
        nargs=3,
        type=number,
        metavar=("X", "Y", "RADIUS"),
        help="the disk of the map that the robot is in [m], if you know (default: anywhere)",
    )


class _AreaAction(argparse.Action):
    """Turns ``X Y RADIUS`` into a disk of the map."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: object, _: object = None
    ) -> None:
        assert isinstance(values, list)
        try:
            setattr(namespace, self.dest, Area(*values))
        except ValueError as error:
            parser.error(f"argument --within: {error}")


def _drive_to(arguments: argparse.Namespace) -> int:
    return carry_out(arguments, DriveTo(arguments.x_m, arguments.y_m, Legs(arguments.legs)))


def _place(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("x_m", type=number, metavar="X", help="map x [m]")
    parser.add_argument("y_m", type=number, metavar="Y", help="map y [m]")


def _goal(parser: argparse.ArgumentParser) -> None:
    _place(parser)
    legs_argument(parser)


def _plan(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        way = client.plan_to(arguments.x_m, arguments.y_m)
    if arguments.json:
        print_json(msgspec.to_builtins(way))
    elif way.reason is None:
        corners = ", ".join(f"({x_m:.2f}, {y_m:.2f})" for x_m, y_m in way.waypoints_m)
        out().print(f"{way.length_m:.2f} m, by {corners} m")
    else:
        out().print(f"no way: {way.message}")
    return OK if way.reason is None else FAILED


def _pose(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client, client.subscribe(Topic.POSE) as events:
        while not isinstance(event := events.next(arguments.timeout or _PATIENCE_S), PoseEstimate):
            if event is None:
                raise RequestTimeout("no pose: the daemon is silent")
    if arguments.json:
        print_json(as_json(event))
        return OK
    out().print(estimate_in_words(event))
    for region in event.regions:
        out().print(f"  {region_in_words(region)}")
    return OK


def _watch(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client, client.subscribe(*(arguments.topic or _NEWS)) as events:
        offset_ns = client.hello().wall_offset_ns
        quiet = None if arguments.topic else Quiet()
        for event in events:
            if quiet is not None and not quiet.lets(event):
                continue
            if arguments.json:
                print_json({"event": "gap", **asdict(event)} if isinstance(event, Gap) else as_json(event))
            else:
                out().print(f"{_time_of(event, offset_ns)} {_watched(event, raw=arguments.raw)}")
    return OK


def _time_of(event: Published | Gap, offset_ns: int) -> str:
    """Return when it happened, as the clock on the wall says."""
    if isinstance(event, Gap):
        return " " * len("00:00:00.000")
    return datetime.fromtimestamp((event.time_ns + offset_ns) / NS_PER_S).astimezone().strftime("%H:%M:%S.%f")[:-3]


def _watched(event: Published | Gap, *, raw: bool) -> str:
    if isinstance(event, Gap):
        return _gap_in_words(event)
    return odometry_in_words(event, raw=raw) if isinstance(event, Odometry) else in_words(event)


def _gap_in_words(gap: Gap) -> str:
    return f"{gap.topic}: {'the daemon restarted' if gap.missed is None else f'{gap.missed} messages missed'}"


def _topics(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "topic",
        nargs="*",
        metavar="TOPIC",
        type=_topic,
        help=f"of {', '.join(Topic)} (default: what is news)",
    )
    parser.add_argument("--raw", action="store_true", help="with odometry, show what the encoders counted, too")


def _topic(text: str) -> Topic:
    if text not in tuple(Topic):
        raise argparse.ArgumentTypeError(f"{text!r} is none of {', '.join(Topic)}")
    return Topic(text)


VERBS = (
    mission_verb(
        "localize",
        "sweep where it stands and say where that is on the map in use",
        "robotctl localize --heading-unknown --within 2 3 1.5",
        _localize,
        _known,
        exit_codes=((LOST, "lost"), (AMBIGUOUS, "ambiguous")),
    ),
    mission_verb(
        "resolve",
        "find out which of several places it is: look round, drive to where they differ, look again",
        "robotctl resolve --within 2 3 1.5",
        _resolve,
        _within,
        exit_codes=((LOST, "lost"), (AMBIGUOUS, "ambiguous")),
    ),
    Verb("pose", "print the newest pose estimate", "robotctl pose --json", _pose, asks_daemon=True),
    Verb(
        "watch", "print what happens, as it happens, until Ctrl-C", "robotctl watch pose sweep", _watch, _topics, True
    ),
    Verb(
        "plan",
        "say by which way a place on the map in use is reached, or why not; nothing moves",
        "robotctl plan 2.5 -0.8",
        _plan,
        _place,
        asks_daemon=True,
    ),
    mission_verb(
        "drive-to",
        "drive to a place on the map in use, and stand there",
        "robotctl drive-to 2.5 -0.8",
        _drive_to,
        _goal,
    ),
)
