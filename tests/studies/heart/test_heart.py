"""A little of what ``make heart`` measures: all attacks at once, the front ended in each mode, and the last second."""

import random
import signal
from pathlib import Path

import pytest

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from tests.studies.heart.attackers import ATTACKERS
from tests.studies.heart.endings import MODES, end_front
from tests.studies.heart.last_words import ended_ms, with_a_wide_map
from tests.studies.heart.rows import MEMORY_MIB
from tests.studies.heart.trials import suffer, with_a_large_map
from tests.support.real_rig import child_of, rig

SHARE = 0.2
SOON_MS = 1000.0
"""However busy the machine that runs the tests; how soon it really is, ``make heart`` says."""

pytestmark = pytest.mark.real_clock


def all_threads_are_bounded(pid: int | None) -> bool:
    """Whether no thread began before its process gave up what it did (:mod:`robotd.children.confinement`)."""
    states = [thread.read_text() for thread in Path(f"/proc/{pid}/task").glob("*/status")]
    return bool(states) and all("NoNewPrivs:\t1" in state for state in states)


async def test_a_stop_is_on_the_wires_whatever_other_clients_do(tmp_path: Path) -> None:
    async with rig(tmp_path) as it:
        with_a_large_map(it, OccupancyGrid(GridSpec(0.05, 0.0, 0.0, (400, 400))))
        async with it.daemon() as process:
            suffered = await suffer(it, process.pid, list(ATTACKERS), trials=3, share=SHARE)
            assert suffered.stops.failures == []
            assert max(suffered.stops.found) < SOON_MS
            assert suffered.heart_mib + suffered.front_mib < MEMORY_MIB
            assert suffered.deaths == 0
            assert process.returncode is None


async def test_a_front_that_is_ended_leaves_the_robot_safe_and_is_followed_by_another(tmp_path: Path) -> None:
    async with rig(tmp_path) as it, it.daemon() as process:
        for child in ("robotd.front", "robotd.head"):
            assert all_threads_are_bounded(child_of(process.pid, child)), child
        for mode in MODES:
            ended = await end_front(it, process.pid, mode, signal.SIGKILL)
            assert ended.is_as_before, mode
            assert ended.stop_late_ms is None or ended.stop_late_ms < SOON_MS, mode
        ended = await end_front(it, process.pid, "driving", signal.SIGSTOP)
        assert ended.stop_late_ms is not None
        assert ended.stop_late_ms < SOON_MS
        assert process.returncode is None


async def test_sigterm_ends_a_daemon_whatever_its_head_computes(tmp_path: Path) -> None:
    async with rig(tmp_path) as it:
        with_a_wide_map(it)
        assert await ended_ms(it, random.Random(1)) < SOON_MS
