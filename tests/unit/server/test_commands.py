"""Requests side by side, bounded, once each; and a stop before all of them. Virtual time, a socket of lists."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import msgpack
import pytest

from robotd.contract.envelope import Reply, decode_reply, encode_request
from robotd.contract.missions import DriveTo, Localize
from robotd.contract.request import Request
from robotd.contract.requests import (
    LONGEST_REASON,
    Arm,
    Clear,
    GetStatus,
    Hello,
    MapLoad,
    MapSave,
    MapShow,
    RecordStop,
    Renew,
    Stop,
)
from robotd.core.errors import ServerError
from robotd.server.commands import Commands
from robotd.server.handlers import Handlers
from robotd.server.letters import Letter, letter


class ListSocket:
    """Takes requests from a queue, keeps the replies."""

    def __init__(self) -> None:
        self.requests: asyncio.Queue[list[bytes]] = asyncio.Queue()
        self.sent: list[list[bytes]] = []

    async def receive(self) -> Letter:
        identity, *frames = await self.requests.get()
        return letter(identity, tuple(frames), "")

    def answer(self, route: tuple[bytes, ...], reply: bytes) -> None:
        self.sent.append([*route, reply])

    def ask(self, number: int, command: Request[Any], client: bytes = b"A") -> None:
        self.requests.put_nowait([client, encode_request(number, command)])

    @property
    def replies(self) -> list[Reply]:
        return [decode_reply(frames[-1]) for frames in self.sent]

    @property
    def outcome(self) -> dict[int | None, str]:
        """What became of each request: ``ok``, or the code of the error."""
        return {
            reply.id: reply.result.code if isinstance(reply.result, ServerError) else "ok" for reply in self.replies
        }


@asynccontextmanager
async def served(control: Any) -> AsyncIterator[ListSocket]:
    socket = ListSocket()
    commands = Commands(
        socket,
        Handlers(control, "session", 0.5),
        max_bytes=65536,
        max_pending=4,
        remembered=8,
    )
    task = asyncio.create_task(commands.run())
    try:
        yield socket
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await control.close()


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


async def test_the_log_says_who_asked_for_what_and_what_came_of_it(
    make_control: Any, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    control = make_control()
    control.armed = True
    control.release.clear()
    async with served(control) as socket:
        socket.ask(1, DriveTo(1.5, 2.0), b"\x01\x02")
        socket.ask(2, DriveTo(1.5, 2.5), b"\x03")
        socket.ask(3, Hello())
        socket.ask(4, Stop("a\nb"), b"\x03")
        await asyncio.sleep(1)
    assert caplog.messages == [
        "client 0102: drive_to x_m=1.5 y_m=2.0: mission 1, lease 0.5 s",
        "client 03: drive_to x_m=1.5 y_m=2.5: refused: not now",
        "client 03: stop reason=a\\nb",
    ]


async def test_a_flood_of_refused_requests_does_not_flood_the_log(
    make_control: Any, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    async with served(make_control()) as socket:
        for number in range(300):
            socket.ask(number, Localize())
            await asyncio.sleep(0.001)
        await asyncio.sleep(2)
        socket.ask(300, Localize())
        await asyncio.sleep(1)
    assert len(caplog.messages) < 30
    assert "more like it were not logged" in caplog.messages[-1]


async def test_a_slow_request_holds_nobody_up(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, Arm())
        socket.ask(2, GetStatus(), b"B")
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok"}
        control.arming.set()
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok", 1: "ok"}


async def test_too_many_at_a_time_are_refused_as_busy_but_a_stop_is_not(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        for number in range(10):
            socket.ask(number, Arm(), b"AABBCCDDEE"[number : number + 1])
        socket.ask(19, Stop("enough"))
        await asyncio.sleep(1)
        assert control.calls == ["arm"] * 8 + ["stop: enough"]
        assert socket.outcome == {8: "busy", 9: "busy", 19: "ok"} | dict.fromkeys(range(8), "refused")


async def test_slow_requests_of_one_client_leave_room_for_the_others_and_for_their_renewals(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    control.release.clear()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, Localize(lease_s=0.5), b"B")
        await asyncio.sleep(0.1)
        for number in range(10, 20):
            socket.ask(number, Arm(), b"A")
        socket.ask(2, GetStatus(), b"B")
        for number in range(3, 7):
            socket.ask(number, Renew(1), b"B")
            await asyncio.sleep(0.3)
        assert control.is_busy, "its lease was kept"
        assert socket.outcome == dict.fromkeys(range(1, 7), "ok") | dict.fromkeys(range(12, 20), "busy")


async def test_a_client_that_floods_is_refused_and_others_are_not_and_its_stop_is_obeyed(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        for number in range(1000):
            socket.ask(number, Hello(), b"A")
            await asyncio.sleep(0.0001)
        socket.ask(1001, Stop("enough"), b"A")
        socket.ask(1002, Hello(), b"B")
        await asyncio.sleep(0.1)
        outcome = socket.outcome
        assert 850 < list(outcome.values()).count("busy") < 900
        assert (outcome[1001], outcome[1002], control.armed) == ("ok", "ok", False)
        await asyncio.sleep(1.0)
        socket.ask(1003, Hello(), b"A")
        await asyncio.sleep(0.1)
        assert socket.outcome[1003] == "ok", "it may ask again after a while"


async def test_a_flood_of_many_leaves_renewals_alone(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    control.release.clear()
    async with served(control) as socket:
        socket.ask(1, Localize(lease_s=0.5), b"B")
        for client in range(20):
            for number in range(150):
                socket.ask(number, Hello(), b"F%d" % client)
        for number in range(2, 7):
            await asyncio.sleep(0.3)
            socket.ask(number, Renew(1), b"B")
        socket.ask(7, GetStatus(), b"C")
        await asyncio.sleep(0.1)
        assert control.is_busy
        assert socket.outcome[7] == "ok", "who asks seldom is served"
        assert list(socket.outcome.values()).count("busy") > 0


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


async def test_a_repeat_is_carried_out_once_and_answered_alike(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        for _ in range(3):
            socket.ask(1, MapSave("a"))
            await asyncio.sleep(1)
        assert control.calls == ["save a"]
        assert len(socket.sent) == 3
        assert len({frames[-1] for frames in socket.sent}) == 1


async def test_a_repeat_of_a_request_under_way_is_answered_once(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, Arm())
        socket.ask(1, Arm())
        await asyncio.sleep(1)
        control.arming.set()
        await asyncio.sleep(1)
        assert (control.calls, len(socket.sent)) == (["arm"], 1)


async def test_the_same_number_of_another_client_is_another_request(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, MapSave("a"), b"A")
        socket.ask(1, MapSave("b"), b"B")
        await asyncio.sleep(1)
        assert control.calls == ["save a", "save b"]


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


async def test_a_refused_start_may_be_tried_again_under_a_new_number(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, Localize())
        await asyncio.sleep(1)
        control.armed = True
        socket.ask(1, Localize())
        socket.ask(2, Localize(0.5, 2.0))
        await asyncio.sleep(1)
        assert socket.outcome == {1: "refused", 2: "ok"}
        assert (control.asked, control.leases_s) == ([Localize(0.5)], [2.0])


async def test_the_lease_of_the_settings_holds_unless_another_is_asked_for(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.ask(1, DriveTo(1.0, 2.0))
        await asyncio.sleep(1)
        assert control.leases_s == [0.5]
        assert socket.replies[-1].result == {"mission_id": 1, "lease_s": 0.5}


async def test_errors_of_the_daemon_become_codes(make_control: Any, caplog: pytest.LogCaptureFixture) -> None:
    async with served(make_control()) as socket:
        socket.ask(1, MapShow("nowhere"))
        socket.ask(2, Localize())
        socket.ask(3, Clear())
        packed = msgpack.packb({"v": 1, "id": 4, "cmd": "map_show", "args": {"version": 3}})
        socket.requests.put_nowait([b"A", packed])
        await asyncio.sleep(1)
        assert socket.outcome == {1: "not_found", 2: "refused", 3: "internal", 4: "bad_argument"}
    assert "a bug in the daemon" in caplog.text


async def test_the_envelope_of_a_req_socket_goes_back_with_the_reply(make_control: Any) -> None:
    async with served(make_control()) as socket:
        socket.requests.put_nowait([b"A", b"", encode_request(1, Hello())])
        await asyncio.sleep(1)
        assert socket.sent[0][:2] == [b"A", b""]
        assert socket.outcome == {1: "ok"}


async def test_a_request_of_many_frames_is_refused(make_control: Any) -> None:
    async with served(make_control()) as socket:
        socket.requests.put_nowait([b"A", *[b"x"] * 50])
        await asyncio.sleep(1)
        assert len(socket.sent[0]) == 2
        assert socket.outcome == {None: "malformed"}
