"""When the battery is too low to go on."""

from robotd.contract.device_status import LinkState
from robotd.hardware.devices.drive import Drive


def low_battery(drive: Drive, least_v: float) -> str | None:
    """Say so if the base's battery is below ``least_v`` [V], None if it is not, or if nobody knows.

    A base that has not measured its battery yet says zero.
    """
    readout = drive.readouts.latest
    if readout is None or drive.status.link is not LinkState.READY or not 0.0 < readout.battery_v < least_v:
        return None
    return f"{drive.name}: the battery is at {readout.battery_v:.1f} V, below {least_v:g} V"
