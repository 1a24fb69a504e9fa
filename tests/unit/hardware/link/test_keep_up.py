"""A line is kept up whatever happens to it, and several duties end together."""

import asyncio
import errno
import os
from collections.abc import Callable
from typing import NoReturn

import pytest

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError, RobotdError, TransportError
from robotd.core.together import together
from robotd.hardware.link.keep_up import BACKOFF_MAX_S, BACKOFF_MIN_S, keep_up
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from tests.support.taps import NoTap


class Talker:
    """Talks as it is told to."""

    def __init__(
        self, says: Callable[[int], RobotdError | OSError | None], *, finds_device: Callable[[int], bool]
    ) -> None:
        self.sessions = 0
        self.talks: list[float] = []
        self.losses: list[str] = []
        self._says = says
        self._finds_device = finds_device

    async def talk(self, line: TappedLine) -> NoReturn:
        self.talks.append(now_ns() / NS_PER_S)
        self.sessions += self._finds_device(len(self.talks))
        if error := self._says(len(self.talks)):
            raise error
        await asyncio.get_running_loop().create_future()
        raise AssertionError("for ever is over")

    def line_lost(self, reason: str) -> None:
        self.losses.append(reason)


class Port:
    """A port that remembers its lines."""

    def __init__(self, *, refuses: Callable[[int], bool] = lambda _: False) -> None:
        self.lines: list[MemoryEnd] = []
        self.tries = 0
        self._refuses = refuses

    async def connect(self) -> Transport:
        self.tries += 1
        if self._refuses(self.tries):
            raise TransportError("no such port")
        near, _ = memory_pair()
        self.lines.append(near)
        return near

    def is_closed(self, index: int) -> bool:
        try:
            self.lines[index].write(b"x")
        except TransportError:
            return True
        return False


async def kept_up(talker: Talker, port: Port, seconds: float) -> None:
    task = asyncio.create_task(keep_up("thing", port.connect, NoTap(), talker))
    await asyncio.sleep(seconds)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task


def pauses(talker: Talker) -> list[float]:
    return [round(later - sooner, 6) for sooner, later in zip(talker.talks, talker.talks[1:], strict=False)]


async def test_pauses_double_up_to_a_bound_while_nobody_is_found() -> None:
    talker = Talker(lambda _: LinkTimeout("nobody answers"), finds_device=lambda _: False)
    await kept_up(talker, Port(), 20.0)
    assert pauses(talker) == [0.25, 0.5, 1.0, 2.0, 4.0, 5.0, 5.0]
    assert set(talker.losses) == {"nobody answers"}


async def test_pauses_begin_anew_with_each_session() -> None:
    talker = Talker(lambda _: TransportError("unplugged"), finds_device=lambda talk: talk in {4, 5})
    await kept_up(talker, Port(), 5.0)
    assert pauses(talker)[:6] == [0.25, 0.5, 1.0, BACKOFF_MIN_S, BACKOFF_MIN_S, 0.5]


async def test_a_port_that_is_not_there_is_tried_again_and_again() -> None:
    port = Port(refuses=lambda tries: tries < 4)
    talker = Talker(lambda _: None, finds_device=lambda _: True)
    await kept_up(talker, port, 60.0)
    assert port.tries == 4
    assert talker.losses == ["no such port"] * 3 + ["shut down"]


@pytest.mark.parametrize(
    "error",
    [
        *(TransportError("x"), LinkTimeout("x"), RemoteProtocolError("x"), DeviceError("thing", "x")),
        *(OSError(code, os.strerror(code)) for code in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EIO)),
    ],
)
async def test_nothing_that_a_line_or_a_device_does_ends_it_and_each_line_is_closed(
    error: RobotdError | OSError,
) -> None:
    port = Port()
    talker = Talker(lambda _: error, finds_device=lambda _: False)
    await kept_up(talker, port, 3.0)
    assert len(talker.talks) >= 3
    assert all(port.is_closed(index) for index in range(len(port.lines)))


@pytest.mark.parametrize("code", [errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOSPC])
async def test_no_error_of_the_system_while_it_connects_ends_it(code: int) -> None:
    port, tries = Port(), 0

    async def connect() -> Transport:
        nonlocal tries
        tries += 1
        if tries < 3:
            raise OSError(code, os.strerror(code))
        return await port.connect()

    talker = Talker(lambda _: None, finds_device=lambda _: True)
    task = asyncio.create_task(keep_up("thing", connect, NoTap(), talker))
    await asyncio.sleep(5.0)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert (tries, talker.sessions) == (3, 1)
    assert all(os.strerror(code) in loss for loss in talker.losses[:2])


async def test_cancelled_while_talking_it_closes_the_line_and_says_so() -> None:
    port = Port()
    talker = Talker(lambda _: None, finds_device=lambda _: True)
    await kept_up(talker, port, 1.0)
    assert port.is_closed(0)
    assert talker.losses == ["shut down"]


async def test_cancelled_while_it_pauses_it_ends_at_once() -> None:
    talker = Talker(lambda _: LinkTimeout("nobody"), finds_device=lambda _: False)
    await kept_up(talker, Port(), BACKOFF_MIN_S / 2)
    assert talker.losses == ["nobody"]
    assert BACKOFF_MAX_S > BACKOFF_MIN_S


async def test_duties_end_together_with_the_error_of_the_first() -> None:
    ended: list[str] = []

    async def duty(name: str, seconds: float) -> NoReturn:
        try:
            await asyncio.sleep(seconds)
            raise TransportError(name)
        finally:
            ended.append(name)

    with pytest.raises(TransportError, match="quick"):
        await together(duty("slow", 9.0), duty("quick", 1.0), duty("slower", 10.0))
    assert ended == ["quick", "slow", "slower"]


async def test_of_duties_that_fail_at_the_same_moment_the_first_named_tells_why() -> None:
    lost = asyncio.Event()

    async def duty(name: str) -> NoReturn:
        await lost.wait()
        raise TransportError(name)

    for _ in range(20):
        lost.clear()
        asyncio.get_running_loop().call_soon(lost.set)
        with pytest.raises(TransportError, match="first"):
            await together(*(duty(name) for name in ("first", "second", "third", "fourth")))


async def test_cancelled_duties_all_end() -> None:
    ended: list[int] = []

    async def duty(number: int) -> NoReturn:
        try:
            await asyncio.get_running_loop().create_future()
        finally:
            ended.append(number)
        raise AssertionError("for ever is over")

    task = asyncio.create_task(together(duty(1), duty(2)))
    await asyncio.sleep(0.1)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert ended == [1, 2]
