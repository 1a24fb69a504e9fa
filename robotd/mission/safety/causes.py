"""What stops the robot although no line, client or job brought it: noted in the journal, and taken up from there.

A replay knows what came over the lines and from the clients. What the daemon's own clocks and threads decided it would
have to guess, and it would guess another moment: so each of these is noted where it takes effect, and a replay takes it
up there, with its own clocks silenced.
"""

import logging
from collections.abc import Callable
from typing import Any

import msgspec

from robotd.contract.modes import Mode
from robotd.core.attention import attention
from robotd.core.clock import now_ns
from robotd.core.errors import RecordingError
from robotd.core.text import printable
from robotd.mission.safety.hold import Stall
from robotd.mission.safety.holding import Holding
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.safety.stopper import Stopper
from robotd.recording.entries import STALL
from robotd.recording.journal import Journal

LEASE = "lease"
GO_ON = "go_on"
GIVE_UP = "give_up"
HEAD = "head"
"""Array work cannot be done, for the reason in its argument ``why``."""
SILENCE = "silence"
"""A time ran out in which something should have come, of whatever its argument ``of`` says."""
_ARGUMENTS: dict[str, tuple[str, tuple[type, ...]]] = {
    STALL: ("stood_still_s", (float, int)),
    LEASE: ("mission_id", (int,)),
}
_TEXTS = {SILENCE: "of", HEAD: "why"}
_MAX = 1e9

log = logging.getLogger(__name__)


class Causes:
    """Takes up what comes from within."""

    def __init__(
        self, stopper: Stopper, holding: Holding, lease_expired: Callable[[int], None], journal: Journal
    ) -> None:
        """Hand on to a hold, or to what ends the mission of that number; each cause is noted first."""
        self._stopper = stopper
        self._holding = holding
        self._lease_expired = lease_expired
        self._journal = journal
        # All timers of silence are one class, so one hook hears of each that falls.
        attention().fell = self._fell

    def _fell(self, of: str) -> None:
        self._journal.cause(now_ns(), SILENCE, {"of": of})

    def stalled(self, stall: Stall) -> None:
        """Take up that the event loop stood still; see :meth:`robotd.mission.safety.holding.Holding.stalled`."""
        # In a replay no guard has stopped the base past the loop: there, this is the stop.
        if stall.was_stopped:
            self._stopper.robot.stop_now()
        self._journal.cause(now_ns(), STALL, msgspec.to_builtins(stall))
        self._holding.stalled(stall)

    def go_on(self) -> None:
        """Take up that all has been well for long enough: a held mission goes on."""
        self._journal.cause(now_ns(), GO_ON, {})
        self._holding.go_on()

    def give_up(self) -> None:
        """Take up that a held mission has waited for the base for long enough."""
        self._journal.cause(now_ns(), GIVE_UP, {})
        self._holding.give_up()

    def head_away(self, why: str | None) -> None:
        """Say that the mission waits for the head, or does so no longer: nothing else comes of it."""
        self._holding.head_away(why)

    def head_lost(self, why: str) -> None:
        """Take up that array work cannot be done: a robot that cannot think is not to move either."""
        # Nothing moves, so nothing changes, and a replay need not know of it.
        if self._stopper.mode in {Mode.DISARMED, Mode.FAULT}:
            log.error("%s", why)
            return
        # Before the note: a stop waits for no note.
        self._stopper.robot.stop_now()
        why = printable(why)
        self._journal.cause(now_ns(), HEAD, {"why": why})
        self._stopper.halt(Occasion.STOP, why)

    def repeat(self, name: str, arguments: dict[str, Any]) -> None:
        """Take up a cause as the journal noted it; one of a later version is left out.

        Raises:
            RecordingError: as :func:`check_cause`.
        """
        check_cause(name, arguments)
        if name == STALL:
            self.stalled(msgspec.convert(arguments, Stall))
        elif name == GO_ON:
            self.go_on()
        elif name == GIVE_UP:
            self.give_up()
        elif name == LEASE:
            self._lease_expired(arguments["mission_id"])
        elif name == HEAD:
            self.head_lost(arguments["why"])
        elif name == SILENCE:
            attention().let_fall(arguments["of"])


def check_cause(name: str, arguments: dict[str, Any]) -> None:
    """Refuse a cause that cannot be taken up.

    Raises:
        RecordingError: its arguments do not fit; says what was expected.
    """
    key, kinds = _ARGUMENTS.get(name, ("", ()))
    value: Any = arguments.get(key)
    # By exact type: to `isinstance` a true is a number.
    if kinds and (type(value) not in kinds or not 0 <= value < _MAX):
        raise RecordingError(f"cause {name!r}: expected a number {key!r}, got {str(arguments)[:80]}")
    if name == STALL:
        _check_stall(arguments)
    text = _TEXTS.get(name)
    if text is not None and type(arguments.get(text)) is not str:
        raise RecordingError(f"cause {name!r}: expected a text {text!r}, got {str(arguments)[:80]}")


def _check_stall(arguments: dict[str, Any]) -> None:
    try:
        msgspec.convert(arguments, Stall)
    except msgspec.ValidationError as error:
        raise RecordingError(f"cause {STALL!r}: {error}") from error
