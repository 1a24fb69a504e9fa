"""What the wheels say in a recorded building, from the command line."""

import argparse

SOURCES = ("corrected", "raw")
"""The words of :class:`robotd.sim.recorded_robot.OdometrySource`, which takes long to load; a test compares them."""


def odometry_argument(parser: argparse.ArgumentParser) -> None:
    """Let the command line choose."""
    parser.add_argument(
        "--odometry",
        choices=SOURCES,
        default=SOURCES[0],
        help="in a recorded building: the log's corrected poses, or what its robot believed (default: corrected)",
    )
