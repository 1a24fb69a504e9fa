"""Missions from the command line: shown as they go on, and stopped before anything else when interrupted."""

import json
import math
import os
import signal
from dataclasses import replace
from typing import Any

import pytest

from robotd.cli.main import main
from robotd.contract.area import Area
from robotd.contract.estimate import PoseState
from robotd.contract.events import MissionPhase, MissionProgress, RangeMeasured, SweepDone
from robotd.contract.missions import (
    DriveStraight,
    DriveTo,
    Legs,
    Localize,
    Look,
    MapStart,
    Measure,
    PriorHeading,
    Resolve,
    Scan,
    Turn,
)
from robotd.core.errors import RequestTimeout
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from tests.unit.cli.conftest import ESTIMATE, MISSION_EVENTS


def test_a_mission_is_asked_for_as_it_was_typed(client: Any) -> None:
    main(["localize"])
    main(["localize", "--heading-deg", "90"])
    main(["localize", "--heading-deg", "-270"])
    main(["localize", "--heading-unknown", "--within", "1", "-2", "0.5"])
    main(["localize", "--adaptive"])
    main(["resolve", "--within", "1", "-2", "0.5"])
    main(["drive-to", "1.5", "-2", "--legs", "straight"])
    main(["drive", "-0.5"])
    main(["turn", "-90"])
    main(["look", "90", "-10"])
    main(["measure"])
    client.mission_events = (SweepDone(5, SWEEP), DONE)
    main(["scan"])
    main(["map", "start", "lab", "--stop", "1", "2", "--stop", "-3", "4", "--start", "1", "0", "180"])
    main(["map", "start", "lab"])
    assert [asked for asked in client.asked if asked != "close"] == [
        Localize(None),
        Localize(math.radians(90)),
        Localize(math.radians(90)),
        Localize(heading=PriorHeading.UNKNOWN, within=Area(1.0, -2.0, 0.5)),
        Localize(adaptive=True),
        Resolve(within=Area(1.0, -2.0, 0.5)),
        DriveTo(1.5, -2.0, Legs.STRAIGHT),
        DriveStraight(-0.5),
        Turn(math.radians(-90)),
        Look(math.radians(90), math.radians(-10)),
        Measure(),
        Scan(),
        MapStart.of("lab", ((1.0, 2.0), (-3.0, 4.0)), Pose2(1.0, 0.0, math.pi), Legs.PLANNED),
        MapStart.of("lab", (), IDENTITY, Legs.PLANNED),
    ]


def test_what_is_not_saved_is_given_up_first_if_that_is_asked_for(client: Any) -> None:
    main(["map", "start", "lab", "--discard"])
    assert [asked for asked in client.asked if asked != "close"] == ["map_discard", MapStart.of("lab")]


def test_the_stops_of_a_world_need_not_be_typed(client: Any) -> None:
    main(["map", "start", "o", "--world", "office"])
    mission = client.asked[0]
    assert mission.start != IDENTITY
    assert len(mission.stops_m) > 3


def test_a_localization_ends_with_the_pose(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["localize"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "localized: x 1.000 m, y 2.000 m, heading 0.0 deg (280 of 300 readings explained)\n"
    assert "240 hits, 40 misses, 20 rejected" in captured.err


def test_all_that_happens_is_a_line_for_each_event(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["localize", "--events"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["event"] for line in lines] == [
        "mission_progress",
        "sweep_progress",
        "pose_estimate",
        "sweep_progress",
        "pose_estimate",
        "mission_progress",
    ]
    assert lines[2]["best"] is None
    assert lines[4]["best"] == {"x_m": 1.0, "y_m": 2.0, "heading_rad": 0.0}
    assert lines[5]["phase"] == "done"


def test_a_localization_as_json_is_its_estimate(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["localize", "--json"]) == 0
    estimate = json.loads(capsys.readouterr().out)
    assert (estimate["event"], estimate["state"], estimate["final"]) == ("pose_estimate", "localized", True)


@pytest.mark.parametrize(("state", "code"), [(PoseState.LOST, 3), (PoseState.AMBIGUOUS, 4)])
def test_lost_and_ambiguous_have_exit_codes_which_the_help_tells(
    client: Any, state: PoseState, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    found = replace(ESTIMATE, state=state, best=None)
    client.mission_events = (*MISSION_EVENTS[:4], found, MISSION_EVENTS[-1])
    assert main(["localize"]) == code
    with pytest.raises(SystemExit):
        main(["localize", "--help"])
    assert f"{code} {state}" in " ".join(capsys.readouterr().out.split())


SWEEP = Sweep(3, IDENTITY, (RangeReading(1, 0.0, ReadingStatus.OK, 1.5),))
MEASURED = (
    RangeMeasured(1, 0, 2, ReadingStatus.OK, 1.5, 310),
    RangeMeasured(2, 1, 2, ReadingStatus.WEAK, None, 7),
)
DONE = MissionProgress(6, 7, "measure", MissionPhase.DONE, 1, 1, "1.5000 m, 1 of 2 measured")


def test_what_was_measured_is_printed(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.mission_events = (*MEASURED, DONE)
    assert main(["measure", "--count", "2"]) == 0
    assert client.asked[0] == Measure(2)
    assert capsys.readouterr().out.splitlines() == [
        "1.500 m, strength 310",
        "weak, strength 7",
        "1.5000 m, 1 of 2 measured",
    ]
    assert main(["measure", "--json"]) == 0
    assert [one["range_m"] for one in json.loads(capsys.readouterr().out)] == [1.5, None]


def test_a_scan_as_json_is_its_sweep(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.mission_events = (SweepDone(5, SWEEP), DONE)
    assert main(["scan", "--json", "--head-only"]) == 0
    assert client.asked[0] == Scan(base_turns=False)
    assert json.loads(capsys.readouterr().out)["sweep"]["readings"][0]["range_m"] == 1.5


@pytest.mark.parametrize("count", ["0", "1001", "x"])
def test_how_often_to_measure_is_judged_before_anybody_is_asked(client: Any, count: str) -> None:
    with pytest.raises(SystemExit):
        main(["measure", "--count", count])
    assert client.asked == []


@pytest.mark.parametrize("as_json", [[], ["--json"]])
def test_a_mission_that_fails_is_exit_code_1(
    client: Any, as_json: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    client.mission_events = (MissionProgress(1, 7, "drive", MissionPhase.FAILED, 0, 1, "unreachable"),)
    assert main(["drive-to", "1", "2", *as_json]) == 1
    assert "robotctl: drive failed: unreachable\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["localize"],
        ["drive-to", "1", "2"],
        ["drive", "1"],
        ["turn", "90"],
        ["look", "9", "0"],
        ["measure"],
        ["scan"],
        ["map", "start", "a"],
        ["localize", "--json"],
        ["localize", "--events"],
    ],
)
def test_an_interrupt_stops_the_robot_first_and_then_says_so(
    client: Any, words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    client.raises = KeyboardInterrupt()
    monkeypatch.setattr("robotd.cli.motion.complain", lambda message: client.asked.append(("said", message)))
    assert main(words) == 130
    assert client.asked[1:] == [
        ("stop", "interrupted at the command line"),
        ("said", "interrupted: the robot was stopped and disarmed"),
        "close",
    ]


def test_an_interrupt_while_an_event_is_shown_stops_the_robot_too(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(document: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("robotd.cli.motion.print_json", interrupt)
    assert main(["localize", "--events"]) == 130
    assert client.asked[1] == ("stop", "interrupted at the command line")


def test_an_interrupt_that_cannot_stop_the_robot_says_what_will(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def silent(reason: str) -> None:
        raise RequestTimeout("no answer from robotd")

    client.raises = KeyboardInterrupt()
    monkeypatch.setattr(client, "stop", silent)
    assert main(["localize"]) == 130
    said = capsys.readouterr().err
    assert "could not be told to stop: no answer from robotd; it stops when its lease runs out" in said


def test_a_second_interrupt_ends_in_words_too(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(reason: str) -> None:
        raise KeyboardInterrupt

    client.raises = KeyboardInterrupt()
    monkeypatch.setattr(client, "stop", interrupted)
    assert main(["localize"]) == 130
    assert "interrupted again, before the robot said that it stopped; its lease ends" in capsys.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_being_ended_is_being_interrupted(client: Any, monkeypatch: pytest.MonkeyPatch, number: signal.Signals) -> None:
    before = signal.getsignal(number)
    monkeypatch.setattr("robotd.cli.motion.print_json", lambda document: os.kill(os.getpid(), number))
    assert main(["localize", "--events"]) == 130
    assert client.asked[1] == ("stop", "interrupted at the command line")
    assert signal.getsignal(number) is before


def test_what_nohup_ignores_stays_ignored(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        monkeypatch.setattr("robotd.cli.motion.print_json", lambda document: os.kill(os.getpid(), signal.SIGHUP))
        assert main(["localize", "--events"]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_sweep_is_drawn_from_above(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    bearings = [math.radians(at) for at in range(0, 360, 2)]
    square = [1.5 / max(abs(math.cos(bearing)), abs(math.sin(bearing))) for bearing in bearings]
    client.mission_events = (SweepDone(5, Sweep.of(bearings, square, 8.0)), DONE)
    assert main(["scan", "--plot"]) == 0
    lines = capsys.readouterr().out.splitlines()
    (line,) = [line for line in lines if "→" in line]
    # Walls on both sides of the robot, as far as each other, with free ground between.
    left, right = line.split("→")
    assert left.rstrip()[-1] in "█▀▄"
    assert right.strip()[0] in "█▀▄"
    assert abs((len(left) - len(left.rstrip())) - (len(right) - len(right.lstrip()))) <= 2
