"""A few robots of the study: in the laboratory few readings are enough, and being carried off shows."""

from pathlib import Path

import pytest

from robotd.sim.buildings.log_file import read_log
from robotd.sim.buildings.world import load_world
from tests.studies.senses import on_logs
from tests.studies.senses.ground import Ground
from tests.studies.senses.trials import Came, carried_off, look, resolve
from tests.support.recorded_room import drive_lines


@pytest.fixture(scope="module")
def laboratory() -> Ground:
    return Ground.of(load_world("laboratory"), 1)


@pytest.mark.parametrize("seed", range(4))
async def test_few_readings_are_enough(laboratory: Ground, seed: int) -> None:
    done = await look(laboratory, seed)
    assert done.came is Came.RIGHT
    assert done.readings <= 40


async def test_being_carried_off_shows_at_the_next_look(laboratory: Ground) -> None:
    done = await carried_off(laboratory, 0)
    assert done is not None
    assert done.noticed
    assert done.came is Came.RIGHT


async def test_where_no_place_is_like_another_nothing_is_driven(laboratory: Ground) -> None:
    done = await resolve(laboratory, 0)
    assert (done.came, done.stops, done.way_m) == (Came.RIGHT, 1, 0.0)


def test_in_a_recorded_room_mapped_from_its_odometry_being_carried_off_shows(tmp_path: Path) -> None:
    log = tmp_path / "room.log"
    log.write_text("\n".join(drive_lines(60)))
    ground = on_logs.LoggedGround.of(read_log(log).scans, 8)
    tried = [on_logs.carried_off(ground, robot) for robot in range(8)]
    carried = [one.carried for one in tried if one.carried is not None]
    assert carried
    assert all(one.noticed and one.came is Came.RIGHT for one in carried)
    assert not any(one.known is Came.WRONG for one in tried)
