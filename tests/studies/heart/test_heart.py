"""A little of what ``make heart`` measures: each attack on a real daemon, and the front ended in each mode."""

import signal
from pathlib import Path

import pytest

from tests.studies.heart.attackers import ATTACKERS
from tests.studies.heart.endings import MODES, end_front
from tests.studies.heart.run import MEMORY_MIB
from tests.studies.heart.trials import suffer, with_a_large_map
from tests.support.real_rig import rig

SHARE = 0.2
SOON_MS = 1000.0
"""However busy the machine that runs the tests; how soon it really is, ``make heart`` says."""

pytestmark = pytest.mark.real_clock


async def test_a_stop_is_on_the_wires_whatever_other_clients_do(tmp_path: Path) -> None:
    async with rig(tmp_path) as it:
        with_a_large_map(it)
        async with it.daemon() as process:
            for attack in ATTACKERS:
                suffered = await suffer(it, process.pid, attack, trials=1, share=SHARE)
                assert max(suffered.stops_ms) < SOON_MS, attack
                assert suffered.heart_mib + suffered.front_mib < MEMORY_MIB, attack
                assert suffered.deaths == 0, attack
            assert process.returncode is None


async def test_a_front_that_is_ended_leaves_the_robot_safe_and_is_followed_by_another(tmp_path: Path) -> None:
    async with rig(tmp_path) as it, it.daemon() as process:
        for mode in MODES:
            ended = await end_front(it, process.pid, mode, signal.SIGKILL)
            assert ended.is_as_before, mode
            assert ended.stop_late_ms is None or ended.stop_late_ms < SOON_MS, mode
        ended = await end_front(it, process.pid, "driving", signal.SIGSTOP)
        assert ended.stop_late_ms is not None
        assert ended.stop_late_ms < SOON_MS
        assert process.returncode is None
