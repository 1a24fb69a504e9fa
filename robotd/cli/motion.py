"""Missions from the command line. Whatever interrupts one, the robot is stopped first and then people are told."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robotd.cli.connection import connect
from robotd.cli.exit_codes import INTERRUPTED, OK
from robotd.cli.show.terminal import complain, out, print_json
from robotd.cli.show.wording import as_json
from robotd.cli.verb import Verb
from robotd.client.mission_run import MissionEvent
from robotd.contract.events import MissionProgress, SweepProgress
from robotd.contract.missions import Legs, Mission
from robotd.core.errors import RobotdError

if TYPE_CHECKING:
    from rich.text import Text

    from robotd.client import Client


@dataclass(frozen=True, slots=True)
class MissionOutcome:
    """What came of a mission that was done."""

    document: Any
    """For programs."""
    words: str
    """For people; with line breaks where it is more than a line."""
    code: int = OK
    picture: "Text | None" = None
    """For people, too, if it was asked for."""


Conclude = Callable[[list[MissionEvent]], MissionOutcome]
"""Tells from all that happened what came of it; progress within sweeps is left out."""


def last_word(events: list[MissionEvent]) -> MissionOutcome:
    """Conclude with what the mission said at its end."""
    last = next(event for event in reversed(events) if isinstance(event, MissionProgress))
    return MissionOutcome(as_json(last), last.message)


def carry_out(arguments: argparse.Namespace, mission: Mission, conclude: Conclude = last_word) -> int:
    """Run a mission to its end, show how it gets on, and return the exit code; Ctrl-C stops the robot.

    Raises:
        MissionError: it was stopped, or it failed.
    """
    with connect(arguments) as client:
        try:
            return _follow(client, mission, conclude, arguments)
        except KeyboardInterrupt:
            return stopped(client)


@contextmanager
def shown(client: "Client", mission: Mission) -> Iterator[Iterator[MissionEvent]]:
    """Start a mission and yield what happens, with bars that show it."""
    from robotd.cli.show.progress import MissionBars  # noqa: PLC0415  # where no mission begins, nobody waits for bars

    # Closed at once where it is left: the generator stops the robot, and must not wait for a collection of
    # garbage.
    with closing(client.run_mission(mission)) as events, MissionBars() as bars:

        def each() -> Iterator[MissionEvent]:
            for event in events:
                bars.show(event)
                yield event

        yield each()


def _follow(client: "Client", mission: Mission, conclude: Conclude, arguments: argparse.Namespace) -> int:
    if arguments.events:
        with closing(client.run_mission(mission)) as events:
            kept = [event for event in events if _tell(event)]
    else:
        with shown(client, mission) as events:
            # Three hundred of a sweep, and nothing is concluded from them.
            kept = [event for event in events if not isinstance(event, SweepProgress)]
    outcome = conclude(kept)
    if arguments.json and not arguments.events:
        print_json(outcome.document)
    elif not arguments.events:
        out().print(outcome.words)
        if outcome.picture is not None:
            out().print(outcome.picture)
    return outcome.code


def _tell(event: MissionEvent) -> bool:
    """Print an event for programs; return whether it is one to conclude from."""
    print_json(as_json(event))
    return not isinstance(event, SweepProgress)


def stopped(client: "Client") -> int:
    """Stop the robot, then say so; if it cannot be told, its lease will stop it, and that is said too."""
    try:
        # Before anything is said: printing may wait for a terminal.
        client.stop("interrupted at the command line")
    except RobotdError as error:
        complain(f"interrupted, and the robot could not be told to stop: {error}; it stops when its lease runs out")
    except KeyboardInterrupt:
        complain("interrupted again, before the robot said that it stopped; its lease ends soon")
    else:
        complain("interrupted: the robot was stopped and disarmed")
    return INTERRUPTED


def mission_verb(
    name: str,
    summary: str,
    example: str,
    run: Callable[[argparse.Namespace], int],
    arguments: Callable[[argparse.ArgumentParser], None],
    *,
    exit_codes: tuple[tuple[int, str], ...] = (),
) -> Verb:
    """Return a verb that carries out a mission: it can tell all that happens, too."""

    def all_arguments(parser: argparse.ArgumentParser) -> None:
        arguments(parser)
        parser.add_argument("--events", action="store_true", help="print JSON: a line for all that happens on the way")

    return Verb(name, summary, example, run, all_arguments, asks_daemon=True, exit_codes=exit_codes)


def legs_argument(parser: argparse.ArgumentParser) -> None:
    """Let the command line choose how the robot gets from place to place."""
    parser.add_argument(
        "--legs",
        choices=[legs.value for legs in Legs],
        default=Legs.PLANNED.value,
        help="round the obstacles on the map, or straight, as you know it to be free (default: planned)",
    )
