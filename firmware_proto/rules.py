"""What a board does with each request: in which states it is allowed, and whether a repeat is recognized."""

from dataclasses import dataclass

from firmware_proto.common import (
    Arm,
    BoardState,
    Clear,
    Configure,
    Disarm,
    Hello,
    Identify,
    Kill,
    Ping,
    Stop,
)
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.pantilt_messages import Aim, ReadAim, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot
from firmware_proto.schema import Message

_ALWAYS = frozenset(BoardState)
_IN_SESSION = _ALWAYS - {BoardState.BOOT}
_CONFIGURED = _IN_SESSION - {BoardState.IDENTIFIED}
_HEALTHY = _CONFIGURED - {BoardState.FAULT}
_ARMED = frozenset({BoardState.ARMED})


@dataclass(frozen=True, slots=True)
class Rule:
    """How one request is treated."""

    states: frozenset[BoardState]
    """Where it is allowed; elsewhere the answer is NACK ``WRONG_STATE``."""
    deduplicated: bool
    """Whether a repeat (same type, same seq) gets the same reply without being executed again."""

    def allows(self, beneath: BoardState, *, faulted: bool) -> bool:
        """Say whether the request may be executed.

        ``FAULT`` lies over the state that a board would otherwise be in: both must allow it.
        """
        return beneath in self.states and (not faulted or BoardState.FAULT in self.states)


RULES: dict[type[Message], Rule] = {
    Hello: Rule(_ALWAYS, deduplicated=False),
    Ping: Rule(_ALWAYS, deduplicated=False),
    Identify: Rule(_IN_SESSION, deduplicated=False),
    # Deduplicated is what would do something twice; what only tells, or may be done twice, needs no memory on
    # the board.
    Configure: Rule(_IN_SESSION, deduplicated=True),
    Arm: Rule(_HEALTHY, deduplicated=True),
    Disarm: Rule(_CONFIGURED, deduplicated=True),
    Clear: Rule(_CONFIGURED, deduplicated=True),
    # In every state, even before a session: a host that has just started may find the robot driving.
    Stop: Rule(_ALWAYS, deduplicated=False),
    Kill: Rule(_ALWAYS, deduplicated=False),
    SetVelocity: Rule(_ARMED, deduplicated=False),
    Aim: Rule(_ARMED, deduplicated=True),
    ReadAim: Rule(_IN_SESSION, deduplicated=False),
    ReadLimits: Rule(_IN_SESSION, deduplicated=False),
    SetLaser: Rule(_HEALTHY, deduplicated=True),
    Shoot: Rule(_HEALTHY, deduplicated=True),
}
"""One rule for each request of each board."""
