"""What the laser of a simulated robot would measure if it measured without error, to hold shots against."""

from robotd.sim.robot import SimulatedRobot


def true_range_m(robot: SimulatedRobot) -> float:
    """Return the way of the light to the first wall or the floor, as the head points; ``inf`` if there is neither."""
    return robot._laser._true_range_m(*robot._head.beam_rad)
