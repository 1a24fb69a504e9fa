"""Requests side by side, bounded, once each; and a stop before all of them. Virtual time, a socket of lists."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any

import pytest

from robotd.core.errors import MapError, ServerError
from robotd.maps.store import MapEntry
from robotd.mission.requests import LocalizeMission
from robotd.server import api
from robotd.server.commands import Commands
from robotd.server.envelope import Reply, decode_reply, encode_request
from robotd.server.handlers import Handlers
from robotd.server.outcomes import Outcomes


class ListSocket:
    """Takes requests from a queue, keeps the replies."""

    def __init__(self) -> None:
        self.requests: asyncio.Queue[list[bytes]] = asyncio.Queue()
        self.sent: list[list[bytes]] = []

    async def recv_multipart(self) -> list[bytes]:
        return await self.requests.get()

    async def send_multipart(self, frames: list[bytes]) -> None:
        self.sent.append(frames)

    def ask(self, number: int, command: api.Command[Any], client: bytes = b"A") -> None:
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
    outcomes = Outcomes()
    commands = Commands(
        socket,  # type: ignore[arg-type]  # the two methods it uses
        Handlers(control, outcomes, "session", 0.5),
        max_bytes=65536,
        max_pending=4,
        remembered=8,
    )
    tasks = [asyncio.create_task(commands.run()), asyncio.create_task(outcomes.follow(control.events))]
    try:
        yield socket
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await control.close()


async def test_a_slow_request_holds_nobody_up(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, api.Arm())
        socket.ask(2, api.GetStatus(), b"B")
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok"}
        control.arming.set()
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok", 1: "ok"}


async def test_too_many_at_a_time_are_refused_as_busy_but_a_stop_is_not(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        for number in range(6):
            socket.ask(number, api.Arm())
        socket.ask(9, api.Stop("enough"))
        await asyncio.sleep(1)
        assert control.calls == ["arm"] * 4 + ["stop: enough"]
        assert socket.outcome == {4: "busy", 5: "busy", 9: "ok"} | dict.fromkeys(range(4), "refused")


async def test_a_stop_overtakes_an_arm_and_the_robot_stays_disarmed(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, api.Arm())
        await asyncio.sleep(1)
        socket.ask(2, api.Stop(), b"B")
        await asyncio.sleep(1)
        control.arming.set()
        await asyncio.sleep(1)
        assert socket.outcome == {2: "ok", 1: "refused"}
        assert not control.armed


async def test_an_arm_and_a_stop_that_come_together_leave_it_disarmed(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, api.Arm())
        socket.ask(2, api.Stop())
        await asyncio.sleep(1)
        assert set(socket.outcome) == {1, 2}
        assert not control.armed


async def test_a_repeat_is_carried_out_once_and_answered_alike(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        for _ in range(3):
            socket.ask(1, api.MapSave("a"))
            await asyncio.sleep(1)
        assert control.calls == ["save a"]
        assert len(socket.sent) == 3
        assert len({frames[-1] for frames in socket.sent}) == 1


async def test_a_repeat_of_a_request_under_way_is_answered_once(make_control: Any) -> None:
    control = make_control()
    control.arming.clear()
    async with served(control) as socket:
        socket.ask(1, api.Arm())
        socket.ask(1, api.Arm())
        await asyncio.sleep(1)
        control.arming.set()
        await asyncio.sleep(1)
        assert (control.calls, len(socket.sent)) == (["arm"], 1)


async def test_the_same_number_of_another_client_is_another_request(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, api.MapSave("a"), b"A")
        socket.ask(1, api.MapSave("b"), b"B")
        await asyncio.sleep(1)
        assert control.calls == ["save a", "save b"]


async def test_a_stop_is_never_answered_from_memory(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        for _ in range(2):
            socket.ask(1, api.Stop("again"))
            await asyncio.sleep(1)
        socket.ask(1, api.MapSave("a"))
        await asyncio.sleep(1)
        socket.ask(1, api.Stop("even under a used number"))
        await asyncio.sleep(1)
        assert control.calls == ["stop: again"] * 2 + ["save a", "stop: even under a used number"]


async def test_a_refused_start_may_be_tried_again_under_a_new_number(make_control: Any) -> None:
    control = make_control()
    async with served(control) as socket:
        socket.ask(1, api.Localize())
        await asyncio.sleep(1)
        control.armed = True
        socket.ask(1, api.Localize())
        socket.ask(2, api.Localize(0.5, 2.0))
        await asyncio.sleep(1)
        assert socket.outcome == {1: "refused", 2: "ok"}
        assert (control.asked, control.leases_s) == ([LocalizeMission(0.5)], [2.0])


async def test_the_lease_of_the_settings_holds_unless_another_is_asked_for(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.ask(1, api.DriveTo(1.0, 2.0))
        await asyncio.sleep(1)
        assert control.leases_s == [0.5]
        assert socket.replies[-1].result == {"mission_id": 1, "lease_s": 0.5}


async def test_a_renewal_tells_the_end_of_a_mission_even_if_it_comes_in_the_same_moment(make_control: Any) -> None:
    control = make_control()
    control.armed = True
    async with served(control) as socket:
        socket.ask(1, api.Localize())
        socket.ask(2, api.Renew(1))
        await asyncio.sleep(1)
        socket.ask(3, api.Renew(1))
        socket.ask(4, api.Renew(8))
        await asyncio.sleep(1)
        assert socket.outcome == {1: "ok", 2: "ok", 3: "ok", 4: "refused"}
        last = next(reply.result for reply in socket.replies if reply.id == 3)
        assert isinstance(last, dict)
        assert last["mission"]["phase"] == "done"


async def test_errors_of_the_daemon_become_codes(make_control: Any, caplog: pytest.LogCaptureFixture) -> None:
    async with served(make_control()) as socket:
        socket.ask(1, api.MapShow("nowhere"))
        socket.ask(2, api.Localize())
        socket.ask(3, api.Clear())
        socket.ask(4, api.MapShow(version=3))
        await asyncio.sleep(1)
        assert socket.outcome == {1: "not_found", 2: "refused", 3: "internal", 4: "bad_argument"}
    assert "a bug in the daemon" in caplog.text


async def test_a_map_that_cannot_be_saved_is_not_one_that_is_not_there(
    make_control: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def full(name: str | None) -> MapEntry:
        raise MapError("cannot save map a: No space left on device")

    control = make_control()
    status = control.status
    monkeypatch.setattr(control, "save_map", full)
    async with served(control) as socket:
        socket.ask(1, api.MapSave())
        await asyncio.sleep(1)
        monkeypatch.setattr(type(control), "status", property(lambda _: replace(status, map_id="d1")))
        socket.ask(2, api.MapSave())
        await asyncio.sleep(1)
        assert socket.outcome == {1: "not_found", 2: "refused"}


async def test_the_envelope_of_a_req_socket_goes_back_with_the_reply(make_control: Any) -> None:
    async with served(make_control()) as socket:
        socket.requests.put_nowait([b"A", b"", encode_request(1, api.Hello())])
        await asyncio.sleep(1)
        assert socket.sent[0][:2] == [b"A", b""]
        assert socket.outcome == {1: "ok"}


async def test_a_request_of_many_frames_is_refused(make_control: Any) -> None:
    async with served(make_control()) as socket:
        socket.requests.put_nowait([b"A", *[b"x"] * 50])
        await asyncio.sleep(1)
        assert len(socket.sent[0]) == 2
        assert socket.outcome == {None: "malformed"}


async def test_every_command_has_a_handler(make_control: Any) -> None:
    handlers = Handlers(make_control(), Outcomes(), "", 0.5)
    assert set(handlers._table) == set(api.COMMANDS.values())
