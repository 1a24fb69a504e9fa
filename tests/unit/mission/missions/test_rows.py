"""Every kind of mission has its row."""

from robotd.contract.missions import MISSIONS
from robotd.mission.missions.rows import MISSION_ROWS


def test_every_kind_of_mission_has_its_row() -> None:
    assert set(MISSION_ROWS) == set(MISSIONS)
