"""``explore``: what it asks for, what it says in the end, and what it does first to go on with a map."""

import json

import pytest

from robotd.cli.main import main
from robotd.contract.area import Bounds
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.explored import ExploringEnded, LeftOpen, StopChosen
from robotd.contract.missions import Explore, Localize, PriorHeading
from robotd.core.pose import Pose2
from tests.unit.cli.conftest import ESTIMATE, FakeClient

LEFT = LeftOpen(4.5, 0.25, 0.75, "no_way")
ENDED = ExploringEnded(9, "new-1", "unreachable", 6, 12.25, 31.5, (LEFT,))


def explored(ended: ExploringEnded) -> tuple[MissionProgress | ExploringEnded | StopChosen, ...]:
    return (
        MissionProgress(1, 7, "explore", MissionPhase.STARTED, 0, 100),
        StopChosen(2, "new-1", 1, 1.5, 2.0, "3.5 m2 more expected", ()),
        ended,
        MissionProgress(9, 7, "explore", MissionPhase.DONE, 6, 6, ended.words),
    )


def test_what_is_given_is_asked_for(client: FakeClient, capsys: pytest.CaptureFixture[str]) -> None:
    client.mission_events = explored(ENDED)
    words = ["--bounds", "-1", "-1", "6", "4", "--stop", "1", "2", "--stops-max", "9", "--way-max", "50"]
    assert main(["explore", "lab", *words, "--minutes", "2", "--return", "--start", "1", "0", "90"]) == 0
    (mission,) = [asked for asked in client.asked if isinstance(asked, Explore)]
    assert mission == Explore.of(
        "lab",
        Pose2(1.0, 0.0, mission.start.heading_rad),
        within=Bounds(-1.0, -1.0, 6.0, 4.0),
        stops_m=((1.0, 2.0),),
        stops_max=9,
        way_max_m=50.0,
        time_max_s=120.0,
        returns=True,
    )
    said = capsys.readouterr().out
    assert "what is left cannot be seen from where the robot can go: 6 stops, 12.2 m of way, 31.5 m2 seen" in said
    assert "left open at (4.50, 0.25) m, 0.8 m wide: no way leads near" in said
    assert "robotctl map save" in said


def test_programs_get_the_end_and_the_exit_code_says_lost(
    client: FakeClient, capsys: pytest.CaptureFixture[str]
) -> None:
    client.mission_events = explored(ExploringEnded(9, "new-1", "lost", 6, 12.25, 31.5, ()))
    assert main(["explore", "lab", "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["ending"] == "lost"


@pytest.mark.parametrize("words", [["--bounds", "1", "1", "0", "2"], ["--stops-max", "0"], ["--minutes", "-1"]])
def test_what_cannot_be_meant_is_wrong_usage(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["explore", "lab", *words])
    assert refused.value.code == 2
    assert words[0] in capsys.readouterr().err


def test_to_go_on_it_takes_the_newest_map_of_that_name(client: FakeClient) -> None:
    client.mission_events = explored(ENDED)
    assert main(["explore", "lab", "--resume"]) == 0
    assert ("map_load", "lab", 3, None) in client.asked
    assert [asked.resume for asked in client.asked if isinstance(asked, Explore)] == [True]


def test_where_it_is_not_known_it_looks_round_first(client: FakeClient) -> None:
    client.published = []
    client.mission_events = (ESTIMATE, *explored(ENDED))
    assert main(["explore", "lab", "--resume"]) == 0
    missions = [asked for asked in client.asked if isinstance(asked, Localize | Explore)]
    assert missions == [Localize(heading=PriorHeading.UNKNOWN), Explore.of("lab", resume=True)]


def test_without_such_a_map_there_is_nothing_to_go_on_with(
    client: FakeClient, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["explore", "kitchen", "--resume"]) == 1
    assert "no map kitchen is in use or in the store" in capsys.readouterr().err
