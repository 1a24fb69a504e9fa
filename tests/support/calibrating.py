"""A calibration carried out on a whole robot on the virtual clock."""

from robotd.calibration.found import Calibration, Constants, Found, Procedure, Seen
from robotd.config import Config
from robotd.contract.events import SweepDone
from tests.support.living import Living


def constants(config: Config) -> Constants:
    return Constants(
        config.drive.counts_per_m,
        config.drive.counts_per_rad,
        config.pantilt.pan_zero_rad,
        config.pantilt.backlash_rad,
        config.rangefinder.range_bias_m,
    )


async def carried_out(it: Living, procedure: Procedure) -> Calibration:
    step = next(procedure)
    while True:
        said = await it.done(step.mission)
        sweeps = [event.sweep for event in said if isinstance(event, SweepDone)]
        odometry = it.daemon.robot.drive.odometry.latest
        seen = Seen(odometry.counts if odometry else None, sweeps[-1] if sweeps else None)
        try:
            step = procedure.send(seen)
        except StopIteration as end:
            result: Calibration = end.value
            return result


def by_key(calibration: Calibration) -> dict[str, Found]:
    return {one.key: one for one in calibration.found}
