"""A daemon that explores the office is killed at every write; another one goes on from one of these to the same map."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.config import Config
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from tests.studies.kills.run import is_same
from tests.studies.kills.trial import killed

pytestmark = pytest.mark.slow


def test_a_kill_at_any_write_costs_one_stop_at_most_and_the_map_comes_out_the_same(tmp_path: Path) -> None:
    robot = killed(load_world("office"), 1, tmp_path, replace(Config(), sweep=SweepSettings(readings=150)))
    assert len(robot.cuts) > 40
    assert all(cut.is_prefix and cut.whole_stops - cut.stops <= 1 for cut in robot.cuts)
    states = robot.states()
    assert [cut.stops for cut in states] == list(range(1, len(states) + 1))
    resumed = robot.resumed(states[0])
    assert is_same(resumed), resumed
