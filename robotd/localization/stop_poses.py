"""Who says where the stops of a map in the making are."""

import enum


class StopPoses(enum.StrEnum):
    """Where the stops of a map in the making are."""

    PLACED = "placed"
    """Where their sweeps fit the map so far, fused with odometry; all of them are moved when a loop is closed."""
    ODOMETRY = "odometry"
    """Where the wheels have them."""
