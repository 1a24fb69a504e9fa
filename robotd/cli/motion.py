"""Missions from the command line. Whatever interrupts one, the robot is stopped first and then people are told."""

import argparse
from collections.abc import Iterable
from contextlib import closing
from typing import Protocol

from robotd.cli.connection import connect
from robotd.cli.show.progress import MissionBars
from robotd.cli.show.terminal import complain, out, print_json
from robotd.cli.show.wording import as_json, estimate_in_words
from robotd.cli.verb import FAILED, INTERRUPTED, OK
from robotd.client import Client
from robotd.client.mission_run import MissionEvent
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.missions import Legs, Mission
from robotd.core.errors import MissionError, RobotdError


class _Show(Protocol):
    def __call__(self, event: MissionEvent, /) -> None: ...


def carry_out(arguments: argparse.Namespace, mission: Mission) -> int:
    """Run a mission to its end, show how it gets on, and return the exit code; Ctrl-C stops the robot."""
    with connect(arguments) as client:
        try:
            return _follow(client, mission, as_lines=arguments.json)
        except KeyboardInterrupt:
            return _stop(client)


def _follow(client: Client, mission: Mission, *, as_lines: bool) -> int:
    with closing(client.run_mission(mission)) as events:
        try:
            if as_lines:
                _show_each(events, lambda event: print_json(as_json(event)))
                return OK
            with MissionBars() as bars:
                found = _show_each(events, bars.show)
        except MissionError as error:
            complain(f"robotctl: {error}")
            return FAILED
    if found is not None:
        out().print(estimate_in_words(found))
    return OK


def _show_each(events: Iterable[MissionEvent], show: _Show) -> PoseEstimate | None:
    """Show the events as they come and return what a localization among them found."""
    found = None
    for event in events:
        show(event)
        if isinstance(event, PoseEstimate) and event.final and event.state is not PoseState.PREDICTED:
            found = event
    return found


def _stop(client: Client) -> int:
    """Stop the robot, then say so; if it cannot be told, its lease will stop it, and that is said too."""
    try:
        client.stop("interrupted at the command line")
    except RobotdError as error:
        complain(f"interrupted, and the robot could not be told to stop: {error}; it stops when its lease runs out")
    except KeyboardInterrupt:
        complain("interrupted again, before the robot said that it stopped; its lease ends soon")
    else:
        complain("interrupted: the robot was stopped and disarmed")
    return INTERRUPTED


def legs_argument(parser: argparse.ArgumentParser) -> None:
    """Let the command line choose how the robot gets from place to place."""
    parser.add_argument(
        "--legs",
        choices=[legs.value for legs in Legs],
        default=Legs.PLANNED.value,
        help="round the obstacles on the map, or straight, as you know it to be free (default: planned)",
    )
