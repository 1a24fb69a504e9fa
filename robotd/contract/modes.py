"""What the robot is allowed to do, in a word."""

import enum


class Mode(enum.StrEnum):
    """What the robot is allowed to do."""

    DISARMED = "disarmed"
    IDLE = "idle"
    MAPPING = "mapping"
    LOCALIZING = "localizing"
    DRIVING = "driving"
    FAULT = "fault"
