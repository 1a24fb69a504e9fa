"""Pictures are made for who looks on: the latest wish alone, and whatever goes wrong with one ends nothing."""

import asyncio
from typing import Any, cast

import pytest

from robotd.contract.events import Event, RankMap
from robotd.core.errors import ChildError
from robotd.core.grid_spec import GridSpec
from robotd.head.head import Head
from robotd.head.jobs import Ranks, RanksShown, ShowRanks
from robotd.head.wire import JobFailed
from robotd.mission.missions.ranks_told import RanksTold
from robotd.mission.whereabouts.map_in_use import MapInUse

SHOWN = RanksShown(Ranks(GridSpec(0.1, -1.0, -2.0, (2, 3)), 2, 75, 40, b"packed"))


class Picturing:
    """A head that answers as it is told, one after the other."""

    def __init__(self, *answers: RanksShown | Exception) -> None:
        self.asked: list[int] = []
        self._answers = list(answers)

    async def ask(self, job: ShowRanks) -> RanksShown:
        self.asked.append(job.stop)
        answer = self._answers.pop(0)
        await asyncio.sleep(1)
        if isinstance(answer, Exception):
            raise answer
        return answer


class Place:
    map_id = "m"


async def told_of(head: Picturing, *, are_wanted: bool = True) -> list[Event]:
    """Ask for a picture each half second, of stops 1, 2 and so on."""
    said: list[Any] = []
    ranks = RanksTold(cast("Head", head), lambda event, made=None: said.append(event))
    ranks.are_wanted = are_wanted
    running = asyncio.create_task(ranks.run())
    for stop in range(1, 5):
        ranks.show(stop, cast("MapInUse", Place()), 7, 3)
        await asyncio.sleep(0.45)
    await asyncio.sleep(5)
    assert not running.done()
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)
    return said


async def test_the_latest_wish_is_granted_when_its_turn_comes() -> None:
    head = Picturing(SHOWN, SHOWN, SHOWN)
    said = await told_of(head)
    assert head.asked == [1, 3, 4]
    assert [(event.map_id, event.generation, event.number) for event in said if isinstance(event, RankMap)] == [
        ("m", 7, 3)
    ] * 3


async def test_nothing_is_made_while_nobody_looks() -> None:
    head = Picturing()
    assert (await told_of(head, are_wanted=False), head.asked) == ([], [])


@pytest.mark.parametrize("error", [ChildError("no head"), JobFailed("a mistake"), MemoryError()], ids=repr)
async def test_a_picture_that_fails_ends_nothing(error: Exception, caplog: pytest.LogCaptureFixture) -> None:
    said = await told_of(Picturing(error, RanksShown(None), SHOWN))
    assert len(said) == 1
    assert "no picture of a stop was made" in caplog.text
