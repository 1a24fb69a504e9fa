"""Subscribe to the pose, arm the robot, and have it localize where it stands.

Run it beside a daemon that has a map in use: python docs/example_client.py. ROBOTD_RUNTIME_DIR says where the daemon's
sockets are, if not in /run/robotd. Ctrl-C stops the robot first.
"""

import asyncio

from robotd.client import AsyncClient
from robotd.contract.estimate import PoseEstimate


def describe(pose: PoseEstimate) -> str:
    """Return a pose as a line."""
    where = f"at x {pose.best.x_m:.3f} m, y {pose.best.y_m:.3f} m" if pose.best else f"in {len(pose.regions)} regions"
    return f"{pose.state} {where}, {pose.best_rank} of {pose.readings} readings explained"


async def print_poses(robot: AsyncClient) -> None:
    """Print what is published, for ever."""
    with robot.subscribe("pose") as poses:
        async for event in poses:  # a Gap comes where messages were missed
            print("published:", describe(event) if isinstance(event, PoseEstimate) else event)


async def main() -> None:
    """Localize, and listen meanwhile."""
    async with AsyncClient() as robot:
        listener = asyncio.create_task(print_poses(robot))
        await robot.arm()
        print("answer:", describe(await robot.localize()))
        listener.cancel()


asyncio.run(main())
