"""Bags need an extra: rosbags reads and writes those of ROS 1 and of ROS 2, without either being there."""

from robotd.core.errors import RobotdError


def require_bags() -> None:
    """Load what reads and writes bags.

    Raises:
        RobotdError: it is not installed; says how to.
    """
    try:
        import rosbags.highlevel  # noqa: F401, PLC0415  # an extra
    except ImportError as error:
        raise RobotdError(
            f"bags of ROS need rosbags ({error}): install the extra bags,"
            " pip install 'robotd[bags]', or pip install -e '.[bags]' in a clone"
        ) from error
