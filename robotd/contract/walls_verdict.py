"""What walls said of the heading, where they were asked."""

import enum


class WallsVerdict(enum.StrEnum):
    """What walls said of the heading."""

    USABLE = "usable"
    """The answer is of the headings that they name."""
    LITTLE_IN_SIGHT = "little_in_sight"
    """Nothing: too little of the walls is in sight."""
    READINGS_CLUTTERED = "readings_cluttered"
    """Nothing: the walls that the readings show run along no dominant axis."""
    MAP_CLUTTERED = "map_cluttered"
    """Nothing: the walls of the map run along no dominant axis."""
    NO_POSE = "no_pose"
    """Headings under which no pose explains the readings; so all were tried."""
