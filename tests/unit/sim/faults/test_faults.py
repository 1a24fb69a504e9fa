"""Each fault does what its sentence says, and nothing more; a seed makes it repeatable."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator

import pytest

from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.memory import MemoryEnd, memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.sim.faults.cable import Cable
from robotd.sim.faults.fault import Fault
from robotd.sim.faults.fault_words import FAULTS, meaning_of

SENT = bytes(range(1, 200)) + b"\0" + b"frame two\0" + b"frame three\0"


class Bench:
    """A cable whose both ends are ours."""

    def __init__(self) -> None:
        self.boards: list[MemoryEnd] = []
        self.strangers: list[MemoryEnd] = []
        self.reboots = 0
        self.plugs: list[bool] = []
        self.cable = Cable(
            "drive",
            lambda: self._open(self.boards),
            stranger=lambda: self._open(self.strangers),
            reboot=self._reboot,
            on_plug=self.plugs.append,
        )

    async def _open(self, ends: list[MemoryEnd]) -> Transport:
        near, far = memory_pair("board")
        ends.append(far)
        return near

    def _reboot(self) -> None:
        self.reboots += 1

    def begin(self, word: str, seed: int = 1) -> None:
        self.cable.set_fault(FAULTS[word](random.Random(seed)))

    async def line(self) -> tuple[Transport, MemoryEnd]:
        host = await self.cable.connect()
        await asyncio.sleep(0.001)
        return host, (self.strangers if self.cable._is_exchanged else self.boards)[-1]


@contextlib.asynccontextmanager
async def bench() -> AsyncIterator[Bench]:
    one = Bench()
    task = asyncio.create_task(one.cable.run())
    try:
        yield one
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def heard(end: Transport, seconds: float) -> bytes:
    said = b""
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(seconds):
            while True:
                said += await end.read()
    return said


async def sent_through(word: str, way: Direction, seed: int = 1, seconds: float = 60.0) -> bytes:
    async with bench() as it:
        host, board = await it.line()
        it.begin(word, seed)
        source, sink = (host, board) if way is Direction.TO_BOARD else (board, host)
        source.write(SENT)
        return await heard(sink, seconds)


BOTH = pytest.mark.parametrize("way", Direction)


@BOTH
async def test_a_sound_cable_carries_everything(way: Direction) -> None:
    async with bench() as it:
        host, board = await it.line()
        source, sink = (host, board) if way is Direction.TO_BOARD else (board, host)
        source.write(SENT)
        assert await heard(sink, 1.0) == SENT


@BOTH
@pytest.mark.parametrize("word", ["garbage", "bitflips", "drop", "double", "halfbaud", "stuck"])
async def test_what_changes_bytes_is_the_same_for_the_same_seed_and_not_what_was_sent(
    word: str, way: Direction
) -> None:
    arrived = [await sent_through(word, way, seed) for seed in (1, *range(1, 8))]
    assert arrived[0] == arrived[1]
    assert all(one != SENT for one in arrived) or word in {"drop", "double"}
    assert len(set(arrived)) > 1 or word == "halfbaud"


@BOTH
async def test_at_half_the_speed_each_byte_becomes_two_wrong_ones(way: Direction) -> None:
    arrived = await sent_through("halfbaud", way)
    assert len(arrived) == 2 * len(SENT)
    assert arrived[:2] == b"\x03\x00"  # of 0x01, low nibble first, each bit twice


@BOTH
async def test_flipped_bits_are_single_ones_and_rare(way: Direction) -> None:
    arrived = await sent_through("bitflips", way)
    wrong = [(a ^ b).bit_count() for a, b in zip(SENT, arrived, strict=True) if a != b]
    assert set(wrong) == {1}
    assert len(wrong) < len(SENT) / 10


@BOTH
async def test_whole_frames_are_dropped_or_doubled(way: Direction) -> None:
    frames = SENT.split(b"\0")
    for word in ("drop", "double"):
        for seed in range(5):
            arrived = (await sent_through(word, way, seed)).split(b"\0")
            assert set(arrived) <= {*frames}
            assert len(arrived) <= len(frames) if word == "drop" else len(arrived) >= len(frames)


@BOTH
async def test_split_frames_arrive_whole_in_the_end_and_in_pieces_before(way: Direction) -> None:
    assert await sent_through("split", way) == SENT
    assert SENT.startswith(early := await sent_through("split", way, seconds=0.005))
    assert 0 < len(early) < 200


async def test_a_silent_board_hears_and_does_not_speak() -> None:
    assert await sent_through("silence", Direction.FROM_BOARD) == b""
    assert await sent_through("silence", Direction.TO_BOARD) == SENT


async def test_a_blocked_line_keeps_what_goes_to_the_board_until_it_is_over() -> None:
    async with bench() as it:
        host, board = await it.line()
        it.begin("blocked")
        host.write(SENT)
        assert await heard(board, 5.0) == b""
        host.write(bytes(64 * 1024))
        with pytest.raises(TransportError, match="stuck"):
            host.write(bytes(5000))
        board.write(b"I still talk")
        assert await heard(host, 0.1) == b"I still talk"
        it.cable.mend()
        assert (await heard(board, 0.1)).startswith(SENT)


async def test_a_dripping_line_says_fifty_bytes_a_second_and_the_rest_when_it_is_over() -> None:
    async with bench() as it:
        host, board = await it.line()
        it.begin("drip")
        board.write(SENT)
        assert await heard(host, 1.01) == SENT[:51]
        it.cable.mend()
        assert await heard(host, 0.1) == SENT[51:]


async def test_a_flood_comes_between_what_the_board_says_and_ends() -> None:
    async with bench() as it:
        host, board = await it.line()
        it.begin("flood")
        board.write(SENT)
        assert 90_000 < len(await heard(host, 1.0)) < 110_000
        it.cable.mend()
        await heard(host, 0.1)
        assert await heard(host, 1.0) == b""


async def test_an_unplugged_line_is_lost_and_not_to_be_had_until_the_plug_is_back_under_another_name() -> None:
    async with bench() as it:
        host, _ = await it.line()
        it.begin("unplug")
        with pytest.raises(TransportError):
            await host.read()
        with pytest.raises(TransportError, match="no such device"):
            await it.cable.connect()
        it.cable.mend()
        again, board = await it.line()
        assert again.name != host.name
        again.write(SENT)
        assert await heard(board, 0.1) == SENT
        assert it.plugs == [False, True]


async def test_a_replugged_line_is_lost_and_at_once_to_be_had_again() -> None:
    async with bench() as it:
        host, _ = await it.line()
        it.begin("replug")
        with pytest.raises(TransportError):
            await host.read()
        again, board = await it.line()
        again.write(SENT)
        assert await heard(board, 0.1) == SENT


async def test_a_stranger_answers_until_the_right_device_is_back() -> None:
    async with bench() as it:
        await it.line()
        it.begin("identity")
        host, stranger = await it.line()
        host.write(b"who is there?")
        assert await heard(stranger, 0.1) == b"who is there?"
        it.cable.mend()
        with pytest.raises(TransportError):
            await host.read()
        host, board = await it.line()
        host.write(b"who is there?")
        assert await heard(board, 0.1) == b"who is there?"


async def test_a_refused_write_takes_the_line_with_it_each_time() -> None:
    async with bench() as it:
        host, board = await it.line()
        it.begin("eio")
        for _ in range(2):
            with pytest.raises(TransportError, match="Input/output error"):
                host.write_urgent(b"stop")
            with pytest.raises(TransportError):
                await host.read()
            assert await heard_until_lost(board) == b""
            host, board = await it.line()


async def heard_until_lost(end: Transport) -> bytes:
    said = b""
    with contextlib.suppress(TransportError):
        while True:
            said += await end.read()
    return said


async def test_a_reboot_takes_the_power_once_and_leaves_the_line() -> None:
    async with bench() as it:
        host, board = await it.line()
        it.begin("reboot")
        it.cable.mend()
        assert it.reboots == 1
        host.write(SENT)
        assert await heard(board, 0.1) == SENT


async def test_only_one_host_is_served_at_a_time_and_the_next_gets_a_fresh_line() -> None:
    async with bench() as it:
        first, _ = await it.line()
        first.close()
        await asyncio.sleep(0.001)
        second, board = await it.line()
        board.write(SENT)
        assert await heard(second, 0.1) == SENT
        assert len(it.boards) == 2


def test_every_fault_has_a_sentence_and_none_is_the_harmless_one() -> None:
    assert len(FAULTS) == len(set(FAULTS.values())) >= 14
    assert all(meaning_of(word).endswith(".") and "\n" not in meaning_of(word) for word in FAULTS)
    assert Fault not in FAULTS.values()
