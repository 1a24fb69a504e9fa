"""The supervisor's modes as a table.

Theory of operation: everything that changes the mode is an :class:`Occasion`; the table says where it
leads; what the table does not name is refused, and nothing else in the daemon assigns a mode. Three
occasions are never refused: ``STOP`` and ``DEVICE_LOST`` lead to ``DISARMED`` from everywhere but
``FAULT``, which stays; ``FAULT`` leads to ``FAULT`` from everywhere. There is no way from ``DISARMED``
to motion that does not pass through an explicit ``ARM``, and none out of ``FAULT`` but ``CLEAR``.

A mission that is *held* (:mod:`robotd.mission.safety.hold`) keeps its mode: the robot was stopped because our own loop
stood still, or odometry was silent, and the mission goes on by itself. Any ``STOP``, ``FAULT`` or ``DEVICE_LOST``
meanwhile ends it as always.
"""

import enum

from robotd.contract.modes import Mode


class Occasion(enum.StrEnum):
    """What can change the mode."""

    ARM = "arm"
    START = "start"
    FINISH = "finish"
    STOP = "stop"
    DEVICE_LOST = "device_lost"
    FAULT = "fault"
    CLEAR = "clear"


TRANSITIONS: dict[tuple[Mode, Occasion], Mode] = {
    (Mode.DISARMED, Occasion.ARM): Mode.IDLE,
    # Armed twice is armed: scripts say it before each mission.
    (Mode.IDLE, Occasion.ARM): Mode.IDLE,
    (Mode.IDLE, Occasion.START): Mode.UNDER_WAY,
    (Mode.UNDER_WAY, Occasion.FINISH): Mode.IDLE,
    # Made for every mode, also those to come: a stop that a new mode had forgotten would be the worst row to
    # miss.
    **{(mode, Occasion.STOP): Mode.DISARMED for mode in Mode if mode is not Mode.FAULT},
    (Mode.FAULT, Occasion.STOP): Mode.FAULT,
    **{(mode, Occasion.DEVICE_LOST): Mode.DISARMED for mode in Mode if mode is not Mode.FAULT},
    (Mode.FAULT, Occasion.DEVICE_LOST): Mode.FAULT,
    **{(mode, Occasion.FAULT): Mode.FAULT for mode in Mode},
    (Mode.FAULT, Occasion.CLEAR): Mode.DISARMED,
    (Mode.DISARMED, Occasion.CLEAR): Mode.DISARMED,
}


def next_mode(mode: Mode, occasion: Occasion) -> Mode | None:
    """Return where an occasion leads, or None if it is refused in this mode."""
    return TRANSITIONS.get((mode, occasion))
