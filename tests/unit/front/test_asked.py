"""The heart's end, on the virtual clock, against a front that is a test: whatever it sends or leaves out."""

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator
from dataclasses import dataclass, replace
from typing import Any

import msgpack
import numpy as np
import pytest

from robotd.children.channel import Channel
from robotd.children.memory_channel import memory_channel
from robotd.contract.envelope import Reply, decode_request, encode_request
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress
from robotd.contract.missions import Localize
from robotd.contract.request import Request
from robotd.contract.requests import Arm, Clear, GetStatus, MapShow, Renew, Stop
from robotd.contract.topics import LogEntry, Topic
from robotd.core.errors import ChildError, MissionError, ServerError
from robotd.core.grid_bytes import packed_cells
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.core.together import together
from robotd.front.heart_side import HeartSide
from robotd.front.messages import Watch, said, settings_of
from robotd.server.settings import ServerSettings
from tests.unit.server.conftest import FakeControl, whole_map

SETTINGS = ServerSettings(lease_s=0.7)
ROOM_BYTES = 2**20


@dataclass
class Front:
    """The other end of the two lanes."""

    control: FakeControl
    stops: Channel
    requests: Channel
    serving: "asyncio.Task[Any]"
    number: int = 0

    def asks(self, request: Request[Any], number: int | None = None) -> int:
        self.number = self.number + 1 if number is None else number
        assert self.requests.send(encode_request(self.number, request))
        return self.number

    def stop(self, number: int | None = None) -> int:
        self.number = self.number + 1 if number is None else number
        assert self.stops.send(encode_request(self.number, Stop("enough")))
        return self.number

    async def answers(self, count: int) -> dict[int, Any]:
        """What became of each request: its result, or the code of its refusal."""
        found: dict[int, Any] = {}
        while len(found) < count:
            match said(await self.requests.receive()):
                case Reply(int(number), ServerError() as error):
                    found[number] = error.code
                case Reply(int(number), result):
                    found[number] = result
                case (int(number), change):
                    found[number] = change
        return found


@contextlib.asynccontextmanager
async def fronted() -> AsyncIterator[Front]:
    control = FakeControl()
    (stops, its_stops), (requests, its_requests) = memory_channel(), memory_channel(ROOM_BYTES)
    side = HeartSide(control, SETTINGS)
    serving = asyncio.create_task(together(side.follow(), side.serve((its_stops, its_requests))))
    front = Front(control, stops, requests, serving)
    assert settings_of(await requests.receive()) == SETTINGS
    try:
        yield front
    finally:
        serving.cancel()
        await asyncio.gather(serving, return_exceptions=True)
        await control.close()


async def test_requests_are_carried_out_and_refused_by_number() -> None:
    async with fronted() as front:
        front.asks(Arm())
        front.asks(MapShow("nowhere"))
        front.asks(Clear())
        front.asks(Localize(lease_s=0.5))
        assert await front.answers(4) == {
            1: {},
            2: "not_found",
            3: "internal",
            4: {"mission_id": 1, "lease_s": 0.5},
        }


async def test_a_stop_that_is_taken_first_holds_for_what_was_asked_before_it() -> None:
    """It has a lane of its own, so it may come before an ``arm`` that a client sent before it."""
    async with fronted() as front:
        stopped = front.stop(number=9)
        await asyncio.sleep(0.1)
        front.asks(Arm(), number=7)
        front.asks(Localize(lease_s=0.5), number=8)
        front.asks(GetStatus(), number=10)
        front.asks(Arm(), number=11)
        answers = await front.answers(5)
        assert (answers[stopped], answers[7], answers[8], answers[11]) == ({}, "refused", "refused", {})
        assert front.control.calls == ["stop: enough", "arm"]


async def test_a_stop_overtakes_an_arm_that_is_under_way() -> None:
    async with fronted() as front:
        front.control.arming.clear()
        arming = front.asks(Arm())
        await asyncio.sleep(0.1)
        stopped = front.stop()
        answers = await front.answers(2)
        assert (answers[arming], answers[stopped]) == ("refused", {})
        # It ended of the stop: given up besides, it would end a turn sooner than in a replay.
        assert front.control.given_up == 0
        front.control.arming.set()
        await asyncio.sleep(0.1)
        assert front.control.status.mode == "disarmed"


async def test_a_front_that_goes_while_it_arms_leaves_a_robot_that_is_stopped() -> None:
    async with fronted() as front:
        front.control.arming.clear()
        front.asks(Arm())
        await asyncio.sleep(0.1)
        front.requests.close()
        with pytest.raises(ChildError, match="the other end is gone"):
            await front.serving
        assert front.control.calls == ["arm", "stop: stopped, as the front that asked to arm is gone"]


async def test_a_front_that_goes_during_a_mission_leaves_it_to_its_lease() -> None:
    async with fronted() as front:
        front.control.release.clear()
        front.asks(Arm())
        front.asks(Localize(lease_s=0.5))
        await front.answers(2)
        front.requests.close()
        with pytest.raises(ChildError):
            await front.serving
        missions = [front.control.status.mission_id]
        await asyncio.sleep(0.6)
        missions.append(front.control.status.mission_id)
        assert missions == [1, None]
        assert not [call for call in front.control.calls if call.startswith("stop")]


@pytest.mark.parametrize(
    ("garbage", "stops"),
    [
        (b"", False),
        (b"\xc1\xff\x00", False),
        (b"x" * 100_000, False),
        (msgpack.packb({"v": 2, "id": 1, "cmd": "arm"}), False),
        (msgpack.packb({"v": 1, "cmd": "stop"}), True),
        (b"please STOP the robot", True),
    ],
)
async def test_garbage_ends_the_front_and_what_speaks_of_a_stop_is_one(garbage: bytes, stops: bool) -> None:
    async with fronted() as front:
        front.control.armed = True
        front.requests.send(garbage)
        with pytest.raises(ChildError, match="it asked what nobody understands"):
            await front.serving
        assert front.control.armed is not stops


@pytest.mark.parametrize("number", [4, 3])
async def test_a_number_that_comes_twice_or_is_older_ends_the_front(number: int) -> None:
    async with fronted() as front:
        front.asks(GetStatus(), number=4)
        front.asks(Arm(), number=number)
        with pytest.raises(ChildError, match=f"it asked number {number} after number 4"):
            await front.serving
        assert front.control.calls == []


async def test_more_than_may_be_under_way_is_refused_and_a_stop_is_not() -> None:
    async with fronted() as front:
        front.control.arming.clear()
        for _ in range(1100):
            front.asks(Arm())
        await asyncio.sleep(0.1)
        front.stop()
        answers = await front.answers(1101)
        assert list(answers.values()).count("busy") == 1100 - 1024
        assert front.control.calls[-1] == "stop: enough"


async def test_a_front_that_floods_keeps_neither_the_loop_nor_a_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = [0]

    def counted(*arguments: Any) -> object:
        taken[-1] += 1
        return decode_request(*arguments)

    async def a_turn() -> None:
        await asyncio.sleep(0)
        assert not front.serving.done(), front.serving.exception()

    monkeypatch.setattr("robotd.front.asked.decode_request", counted)
    async with fronted() as front:
        for _ in range(1000):
            front.asks(GetStatus())
        front.stop()
        while not front.control.calls:
            await a_turn()
        assert sum(taken) < 20, "it waits for none of those that came before it"
        while sum(taken) < 1001:
            taken.append(0)
            await a_turn()
        assert max(taken[1:]) <= 8, "what else the loop has to do has its turn between"
        assert len(await front.answers(1001)) == 1001


async def test_a_front_that_takes_nothing_costs_bounded_memory_and_is_obeyed_all_the_same() -> None:
    async with fronted() as front:
        front.control.map_in_use = whole_map(1)
        for _ in range(2000):
            front.asks(MapShow())
        for time_ns in range(0, 10**12, 10**8):
            front.control.events.publish(Odometry(time_ns, IDENTITY, STANDSTILL))
        await asyncio.sleep(1.0)
        assert front.requests._inbox.bytes <= ROOM_BYTES  # type: ignore[attr-defined]  # what is to be bounded
        front.stop()
        await asyncio.sleep(0.1)
        assert front.control.calls == ["stop: enough"]


async def test_a_map_goes_over_as_it_is() -> None:
    async with fronted() as front:
        packed = replace(whole_map(1), values=np.empty(0, np.uint8), packed=packed_cells(whole_map(1).values))
        for the_map in (whole_map(1), packed):
            front.control.map_in_use = the_map
            front.asks(MapShow())
            (shown,) = (await front.answers(1)).values()
            assert_same(shown, the_map)
        change = MapChanged(
            time_ns=2,
            map_id="d1",
            generation=2,
            spec=whole_map(1).spec,
            whole=False,
            cells=np.array([3, 77], np.intp),
            values=np.array([0, 255], np.uint8),
            stops=4,
        )
        front.control.events.publish(change)
        told = said(await front.requests.receive())
        assert isinstance(told, MapChanged)
        assert_same(told, change)


def assert_same(one: MapChanged, other: MapChanged) -> None:
    np.testing.assert_array_equal(one.cells, other.cells)
    np.testing.assert_array_equal(one.values, other.values)
    for name in ("time_ns", "map_id", "generation", "spec", "whole", "stops", "packed"):
        assert getattr(one, name) == getattr(other, name)


async def test_events_and_the_log_are_told_in_order_and_what_has_no_form_is_left_out(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async with fronted() as front:
        front.control.events.publish(Odometry(2**70, IDENTITY, STANDSTILL))
        front.control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        assert said(await front.requests.receive()) == Odometry(1, IDENTITY, STANDSTILL)
        await asyncio.sleep(0.1)
        logging.getLogger("robotd.mission").warning("a bumper was hit")
        lines = [said(await front.requests.receive()) for _ in range(2)]
        assert [line.message for line in lines if isinstance(line, LogEntry)][1:] == ["a bumper was hit"]
    assert "Odometry was not published" in caplog.text


async def test_a_renewal_after_the_end_tells_the_end_also_to_the_next_front() -> None:
    async with fronted() as front:
        front.asks(Arm())
        front.asks(Localize(lease_s=0.5))
        await front.answers(2)
        await asyncio.sleep(0.1)
        front.asks(Renew(1))
        front.asks(Renew(8))
        answers = await front.answers(2)
        assert answers[3]["mission"]["phase"] == "done"
        assert answers[4] == "refused"


@pytest.mark.parametrize("tells", [True, False])
async def test_a_renewal_between_the_last_step_and_the_word_of_it_is_answered_with_the_end(tells: bool) -> None:
    end = MissionProgress(7, 4, "localize", MissionPhase.DONE, 1, 1, "localized")
    async with fronted() as front:

        async def just_ended(request: Request[Any], client: str = "") -> Any:
            if tells:
                asyncio.get_running_loop().call_soon(front.control.events.publish, end)
            raise MissionError("mission 4 is not under way any more")

        front.control.perform = just_ended  # type: ignore[method-assign]  # it asks nothing else
        front.asks(Renew(4))
        (answer,) = (await front.answers(1)).values()
        assert (answer["mission"]["message"] if tells else answer) == ("localized" if tells else "refused")


async def test_the_heart_hears_what_is_read_for_as_long_as_there_is_a_front() -> None:
    async with fronted() as front:
        front.asks(Watch((Topic.RANK,)))
        front.asks(GetStatus())
        assert len(await front.answers(1)) == 1  # it is the status's: what is read needs no answer
        assert front.control.watched == [{Topic.RANK}]
    assert front.control.watched == [{Topic.RANK}, set()]
