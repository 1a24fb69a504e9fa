"""When the battery is too low to go on, which is a fault like those that devices latch themselves."""

from robotd.contract.device_status import LinkState
from robotd.hardware.devices.drive import Drive
from robotd.mission.three_devices import Robot


def low_battery(drive: Drive, least_v: float) -> str | None:
    """Say so if the base's battery is below ``least_v`` [V], None if it is not, or not known."""
    readout = drive.readouts.latest
    # A readout from before the line was lost says nothing of the battery now.
    volts = None if readout is None or drive.status.link is not LinkState.READY else readout.battery_v
    if volts is None or volts >= least_v:
        return None
    return f"{drive.name}: the battery is at {volts:.1f} V, below {least_v:g} V"


def faults_of(robot: Robot, battery_min_v: float) -> tuple[str, ...]:
    """Return what must be cleared before a robot is armed: its devices' faults, and a battery that is too low [V]."""
    low = low_battery(robot.drive, battery_min_v)
    return robot.faults if low is None else (*robot.faults, low)
