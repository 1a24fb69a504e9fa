"""What goes wrong on the lines of vendor devices stops the robot, too, if later: they speak only when asked."""

import pytest

from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault_words import FAULTS
from tests.studies.faults.cell import run_cell

ROBOTS = {
    "rwi-ascii": ("drive", Dialects(drive="rwi-ascii")),
    "ptu": ("pantilt", Dialects(pantilt="ptu")),
    "dynamixel": ("pantilt", Dialects(pantilt="dynamixel")),
    "dimetix": ("rangefinder", Dialects(rangefinder="dimetix")),
    "tfmini-s": ("rangefinder", Dialects(rangefinder="tfmini-s")),
    "lw20": ("rangefinder", Dialects(rangefinder="lw20")),
    "scip": ("rangefinder", Dialects(pantilt="fixed", rangefinder="scip")),
}
"""Without rFLEX: it has no watchdog, so on a dead line it drives on, as ``docs/safety.md`` says."""
STATES = ("map: drive", "localize", "idle")
CELLS = [
    (dialect, fault, STATES[(row + column) % len(STATES)])
    for row, dialect in enumerate(ROBOTS)
    for column, fault in enumerate(("unplug", "identity", "silence", "garbage", "stuck"))
]
BASE = [("rwi-ascii", fault, "map: drive") for fault in FAULTS if fault != "reboot"]


@pytest.mark.parametrize(("dialect", "fault", "state"), sorted({*CELLS, *BASE}))
def test_the_robot_rests_and_everything_comes_back(dialect: str, fault: str, state: str) -> None:
    device, dialects = ROBOTS[dialect]
    assert run_cell(fault, state, device, dialects=dialects).failures == ()
