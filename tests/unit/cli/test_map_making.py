"""``map continue``: what it does first, and what it asks for."""

import math

import pytest

from robotd.cli.main import main
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import Legs, Localize, MapContinue, PriorHeading
from robotd.core.pose import Pose2
from tests.unit.cli.conftest import ESTIMATE, FakeClient

DONE = MissionProgress(9, 7, "map", MissionPhase.DONE, 1, 2, "2 stops swept")


def test_the_newest_map_of_that_name_is_loaded_and_gone_on_with(client: FakeClient) -> None:
    client.mission_events = (DONE,)
    assert main(["map", "continue", "lab", "--stop", "3", "1", "--legs", "straight"]) == 0
    assert ("map_load", "lab", 3, None) in client.asked
    assert MapContinue.of("lab", ((3.0, 1.0),), None, Legs.STRAIGHT) in client.asked


def test_where_it_is_not_known_it_looks_round_first_unless_somebody_says(client: FakeClient) -> None:
    client.published, client.mission_events = [], (ESTIMATE, DONE)
    assert main(["map", "continue", "lab"]) == 0
    assert main(["map", "continue", "lab", "--robot", "1", "2", "90"]) == 0
    missions = [asked for asked in client.asked if isinstance(asked, Localize | MapContinue)]
    said = MapContinue.of("lab", (), Pose2(1.0, 2.0, math.pi / 2))
    assert missions == [Localize(heading=PriorHeading.UNKNOWN), MapContinue.of("lab"), said]


def test_a_map_that_nobody_has_is_not_begun_by_it(client: FakeClient, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "continue", "kitchen"]) == 1
    assert "no map kitchen is in use or in the store" in capsys.readouterr().err
    assert not [asked for asked in client.asked if isinstance(asked, MapContinue)]
