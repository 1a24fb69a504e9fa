"""Requests side by side, bounded, once each; and a stop before all of them. Virtual time, a socket of lists."""

import asyncio
from typing import Any

import msgpack
import pytest

from robotd.contract.envelope import encode_request
from robotd.contract.missions import DriveTo, Localize
from robotd.contract.requests import (
    Arm,
    Clear,
    GetStatus,
    Hello,
    MapSave,
    MapShow,
    Renew,
    Stop,
)
from tests.unit.server.asked_side import served


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
