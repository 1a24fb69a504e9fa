"""What the robot is allowed to do, and the words that a status has for it."""

import enum

from robotd.contract.missions import MISSIONS


class Mode(enum.StrEnum):
    """What the robot is allowed to do."""

    DISARMED = "disarmed"
    IDLE = "idle"
    UNDER_WAY = "under_way"
    """Carrying out a mission. On the wire each kind of mission has a word of its own, its ``doing``."""
    FAULT = "fault"


MODE_WORDS = (Mode.DISARMED.value, Mode.IDLE.value, *dict.fromkeys(kind.doing for kind in MISSIONS), Mode.FAULT.value)
"""What a status may say."""
