"""The board's clock may fail to learn, in every way: the board is not lost for it, and learning goes on."""

import asyncio
import errno
import os

import pytest

from firmware_proto.common import BoardKind
from robotd.core.clock import TurnCountingLoop, now_ns
from robotd.core.errors import TransportError
from robotd.hardware.link.clock_sync import ClockSync
from robotd.hardware.link.tapped import TappedLine
from robotd.sim.runtime import connectors
from tests.unit.hardware.link.test_reconnect import Diary, link_to, robot
from tests.unit.hardware.link.test_session import bench, serving

ERRORS = [
    *(OSError(number, os.strerror(number)) for number in (errno.EMFILE, errno.ENOSPC, errno.EACCES)),
    OverflowError("too large"),
    RuntimeError("a bug in the daemon"),
]


@pytest.mark.parametrize("error", ERRORS, ids=repr)
async def test_a_clock_that_cannot_learn_ends_no_session_and_it_is_said_once(
    error: Exception, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: object) -> bool:
        raise error

    async with bench(BoardKind.DRIVE) as b, serving(b):
        with monkeypatch.context() as broken:
            broken.setattr(ClockSync, "add", fail)
            await asyncio.sleep(5.5)
        assert b.counters.implausible >= 5
        assert len(caplog.records) == 1
        count = len(b.telemetry)
        await asyncio.sleep(10.0)
        assert len(b.telemetry) > count + 100
        true_us = now_ns() // 1000
        assert abs(b.session.clock.host_ns(b.clock.board_us(true_us)) - true_us * 1000) < 50_000
        assert b.counters.implausible < 8


@pytest.mark.parametrize("error", [TransportError("the line is gone"), *ERRORS[:3]], ids=repr)
@pytest.mark.parametrize("call", ["ahead_ns", "write"])
async def test_a_ping_that_cannot_be_sent_or_used_costs_the_session_and_the_next_one_is_well(
    call: str, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    async with connectors(robot()) as connect:
        link, diary = link_to(connect["drive"]), Diary()
        task = asyncio.create_task(link.run(diary))
        await asyncio.sleep(2.0)
        assert diary.words == ["opened", "ready"]
        with monkeypatch.context() as broken:
            broken.setattr(ClockSync if call == "ahead_ns" else TappedLine, call, fail)
            await asyncio.sleep(3.0)
            assert diary.words[2] == "lost"
            assert str(error) in diary.reasons
        await asyncio.sleep(6.0)
        assert diary.words[-1] == "ready"
        assert not task.done()
        task.cancel()
        await asyncio.wait({task})


async def turns_until_the_end(lost_after_s: float) -> int:
    """Return how many turns of the loop after the line is lost the session says so."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, TurnCountingLoop)
    async with bench(BoardKind.DRIVE) as b:
        lost_turn: asyncio.Future[int] = loop.create_future()
        serving_ = asyncio.create_task(b.session.serve())
        await asyncio.sleep(0)  # pings fall due by whole seconds from here

        def break_down() -> None:
            b.line.close()
            lost_turn.set_result(loop.turn)

        loop.call_later(lost_after_s, break_down)
        with pytest.raises(TransportError):
            await serving_
        return loop.turn - lost_turn.result()


async def test_a_ping_that_falls_due_as_the_line_breaks_does_not_hasten_the_end() -> None:
    assert await turns_until_the_end(1.0) == await turns_until_the_end(0.5)
