"""``map show --live`` and ``top``: the robot on a terminal as it goes, with keys that stop and arm it."""

import argparse
import contextlib
import select
import sys
import termios
import time
import tty
from collections.abc import Iterator

from rich.live import Live

from robotd.cli.connection import connect
from robotd.cli.exit_codes import OK
from robotd.cli.show.dashboard import Dashboard
from robotd.cli.show.half_blocks import Ink, can_draw_blocks
from robotd.cli.show.terminal import out
from robotd.client import Client
from robotd.client.sync_client import Subscription
from robotd.contract.topics import Topic
from robotd.core.errors import RobotdError

_TICK_S = 0.1
_PATIENCE_S = 1.0
"""How long to listen where there is no terminal to go on with."""
_TOPICS = (Topic.MAP, Topic.POSE, Topic.SWEEP, Topic.MISSION, Topic.STATUS, Topic.LOG)


def live(arguments: argparse.Namespace, *, with_map: bool) -> int:
    """Show the robot until q or Ctrl-C, which end the looking and nothing else; without a terminal, once.

    Raises:
        TransportError: there is no daemon.
    """
    console, board = out(), Dashboard()
    ink = Ink(colour=bool(console.is_terminal and console.color_system), blocks=can_draw_blocks(console.encoding))
    with connect(arguments) as client, client.subscribe(*_TOPICS) as events:
        client.hello()
        if not console.is_terminal:
            _hear(events, board, _PATIENCE_S)
            console.print(board.show(console.width, 10_000, ink, with_map=with_map))
            return OK
        with (
            contextlib.suppress(KeyboardInterrupt),
            _keys() as pressed,
            Live(console=console, screen=True, auto_refresh=False) as screen,
        ):
            while (key := pressed()) != "q":
                if key:
                    board.told = _obeyed(client, key) or board.told
                # All that came meanwhile, and then one picture of it.
                _hear(events, board, _TICK_S)
                shown = board.show(console.width, console.height, ink, with_map=with_map)
                screen.update(shown, refresh=True)
    return OK


def _hear(events: Subscription, board: Dashboard, within_s: float) -> None:
    """Take all that comes within this time."""
    end_s = time.monotonic() + within_s
    while (left_s := end_s - time.monotonic()) > 0.0:
        event = events.next(left_s)
        if event is not None:
            board.hear(event)


def _obeyed(client: Client, key: str) -> str:
    """Do what a key stands for, and return what came of it."""
    try:
        if key in {" ", "s"}:
            client.stop("stopped at the command line")
            return "stopped and disarmed"
        if key == "a":
            client.arm()
            return "armed: it may move"
    except RobotdError as error:
        return str(error)
    return ""


@contextlib.contextmanager
def _keys() -> Iterator["_Pressed"]:
    """Take keys as they are pressed; the terminal is as it was afterwards."""
    descriptor = sys.stdin.fileno()
    if not sys.stdin.isatty():
        yield _Pressed(None)
        return
    before = termios.tcgetattr(descriptor)
    tty.setcbreak(descriptor)
    try:
        yield _Pressed(descriptor)
    finally:
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)


class _Pressed:
    """The next key, if one was pressed."""

    def __init__(self, descriptor: int | None) -> None:
        self._descriptor = descriptor

    def __call__(self) -> str:
        """Return it; empty if there is none."""
        if self._descriptor is None or not select.select([self._descriptor], [], [], 0.0)[0]:
            return ""
        return sys.stdin.read(1)
