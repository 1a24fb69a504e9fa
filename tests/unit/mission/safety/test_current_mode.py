"""The mode goes where the table says and nowhere else; a fault keeps its reason; what counts is told."""

import random
from collections.abc import Callable

import pytest

from robotd.contract.modes import Mode
from robotd.core.errors import MissionError
from robotd.mission.safety.current_mode import CurrentMode
from robotd.mission.safety.mode_table import TRANSITIONS, Occasion


@pytest.mark.parametrize("seed", range(20))
async def test_any_sequence_of_occasions_leads_where_the_table_says(
    seed: int, record_property: Callable[[str, object], None]
) -> None:
    record_property("property_cases", 1)
    draw = random.Random(seed)
    told: list[tuple[Mode, str]] = []
    current = CurrentMode(lambda: told.append((current.mode, current.reason)))
    mode, reason, expected = Mode.DISARMED, "started", []
    for number in range(60):
        occasion = draw.choice(list(Occasion))
        leads_to = TRANSITIONS.get((mode, occasion))
        if leads_to is None:
            with pytest.raises(MissionError, match="cannot "):
                current.require(occasion)
        else:
            current.require(occasion)
            reason = reason if (mode, leads_to) == (Mode.FAULT, Mode.FAULT) else f"reason {number}"
            mode = leads_to
            expected.append((mode, reason))
        current.apply(occasion, f"reason {number}")
        assert (current.mode, current.reason) == (mode, reason)
    assert told == expected


async def test_a_status_says_what_a_mission_does_only_while_it_is_under_way() -> None:
    current = CurrentMode(lambda: None)
    current.start("mapping", "mission 1")  # refused: nothing is armed
    assert current.word == "disarmed"
    current.apply(Occasion.ARM, "armed")
    current.start("driving", "mission 2")
    assert (current.mode, current.word) == (Mode.UNDER_WAY, "driving")
    with pytest.raises(MissionError, match=r"^cannot start mapping while driving; wait for its end, or end it: "):
        current.require(Occasion.START, "start mapping")
    current.apply(Occasion.FINISH, "done")
    assert current.word == "idle"


async def test_a_refusal_says_why_the_robot_is_disarmed() -> None:
    current = CurrentMode(lambda: None)
    current.apply(Occasion.STOP, "somebody pressed stop")
    with pytest.raises(MissionError, match="cannot start mapping while disarmed: somebody pressed stop"):
        current.require(Occasion.START, "start mapping")


async def test_a_reason_is_printable_and_bounded() -> None:
    current = CurrentMode(lambda: None)
    current.apply(Occasion.STOP, "\x1b[31m" + "x" * 10_000)
    assert "\x1b" not in current.reason
    assert len(current.reason) <= 500
