"""A stop is obeyed first, and judged afterwards; it overtakes what allows motion."""

import asyncio
from typing import Any

import msgpack
import pytest

from robotd.contract.envelope import encode_request
from robotd.contract.requests import (
    LONGEST_REASON,
    Arm,
    MapLoad,
    MapSave,
    RecordStop,
    Stop,
)
from robotd.core.errors import ServerError
from tests.unit.server.asked_side import served


def stop_with(**fields: Any) -> bytes:
    packed: bytes = msgpack.packb({"v": 1, "id": 7, "cmd": "stop", "args": {}} | fields)
    return packed


ODD_STOPS = {
    "another version": [stop_with(v=2)],
    "an extra key": [stop_with(urgent=True)],
    "capitals": [stop_with(cmd="STOP")],
    "no number": [msgpack.packb({"v": 1, "cmd": "stop"})],
    "an unknown argument": [stop_with(args={"reason": "because", "hard": True})],
    "cut": [stop_with()[:-3]],
    "JSON": [b'{"v": 1, "id": 7, "cmd": "stop"}'],
    "many frames": [stop_with(), b"x", b"y", b"z"],
    "two frames": [b"x", stop_with()],
    "as large as may be": [stop_with(args={"reason": "x", "trace": "y" * 200_000})],
}


@pytest.mark.parametrize("frames", ODD_STOPS.values(), ids=ODD_STOPS.keys())
async def test_a_stop_is_obeyed_first_and_judged_afterwards(make_control: Any, frames: list[bytes]) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.requests.put_nowait([b"A", *frames])
        await asyncio.sleep(0.1)
        assert not control.armed
        assert [call.split(":")[0] for call in control.calls] == ["stop"]
        (reply,) = socket.replies
        assert isinstance(reply.result, ServerError)
        assert "the robot was stopped" in reply.result.message


@pytest.mark.parametrize(
    "args", [[], None, {"reason": None}, {"reason": b"\xff"}, {"reason": "x" * 5000}, {"reason": 1.0}]
)
async def test_a_stop_for_an_odd_reason_is_a_good_one(make_control: Any, args: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.requests.put_nowait([b"A", stop_with(args=args)])
        await asyncio.sleep(0.1)
        assert (control.armed, socket.outcome) == (False, {7: "ok"})
        assert len(control.calls[0]) <= len("stop: ") + LONGEST_REASON


async def test_a_named_stop_for_an_odd_reason_is_a_good_one(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.requests.put_nowait([b"A", stop_with(args={"reason": b"\xff"}, client="anna")])
        await asyncio.sleep(0.1)
        assert (control.armed, socket.outcome) == (False, {7: "ok"})


async def test_a_stop_by_a_client_of_an_odd_name_is_obeyed(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.requests.put_nowait([b"A", stop_with(client="x" * 65)])
        await asyncio.sleep(0.1)
        assert (control.armed, socket.outcome) == (False, {7: "bad_argument"})


async def test_what_moves_the_robot_hears_who_asks(make_control: Any, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    control = make_control()
    async with served(control) as socket:
        socket.requests.put_nowait([b"A", encode_request(1, Arm(), "anna")])
        await asyncio.sleep(0.1)
        socket.ask(2, RecordStop(), client=b"B")
        await asyncio.sleep(0.1)
        assert control.clients == ["anna", "client 42"]
    assert caplog.messages == ["anna, client 41: arm: done", "client 42: record_stop: there was no recording"]


async def test_what_is_no_stop_stops_nothing(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.ask(1, MapLoad("stop"))
        socket.ask(2, RecordStop())
        socket.requests.put_nowait([b"A", stop_with(cmd="map_load", args={"name": "stop", "stop": 1})])
        socket.requests.put_nowait([b"A", encode_request(3, MapLoad("stop"))[:-2]])
        await asyncio.sleep(0.1)
        assert control.armed
        assert socket.outcome == {1: "ok", 2: "ok", 7: "bad_argument", None: "malformed"}


async def test_a_stop_for_which_there_is_no_room_is_obeyed_and_answered(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    control.release.clear()
    async with served(control) as socket:
        for number in range(9):
            socket.ask(number, Stop(), b"%d" % number)
        await asyncio.sleep(0.1)
        assert len(control.calls) == 9
        assert socket.outcome == dict.fromkeys(range(9), "ok")


async def test_a_stop_that_fails_in_the_daemon_does_not_end_what_takes_the_next(
    make_control: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    control = make_control()
    halt = control.halt
    async with served(control) as socket:
        monkeypatch.setattr(control, "halt", lambda reason: 1 / 0)
        socket.ask(1, Stop())
        await asyncio.sleep(0.1)
        monkeypatch.setattr(control, "halt", halt)
        socket.ask(2, Stop("again"))
        await asyncio.sleep(0.1)
        assert control.calls == ["stop: again"]


async def test_a_stop_overtakes_an_arm_and_the_robot_stays_disarmed(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, Arm())
        await asyncio.sleep(1)
        socket.ask(2, Stop(), b"B")
        await asyncio.sleep(1)
        control.arming.set()
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok", 1: "refused"}
        assert not control.armed


async def test_an_arm_and_a_stop_that_come_together_leave_it_disarmed(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, Arm())
        socket.ask(2, Stop())
        await asyncio.sleep(1)
        assert set(socket.outcome) == {1, 2}
        assert not control.armed


async def test_a_stop_is_never_answered_from_memory(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        for _ in range(2):
            socket.ask(1, Stop("again"))
            await asyncio.sleep(1)
        socket.ask(1, MapSave("a"))
        await asyncio.sleep(1)
        socket.ask(1, Stop("even under a used number"))
        await asyncio.sleep(1)
        assert control.calls == ["stop: again"] * 2 + ["save a", "stop: even under a used number"]
