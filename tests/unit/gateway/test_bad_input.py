"""Bad input, kind by kind: answered in words, and nothing is lost.

These kinds are tried where their parts are: a zip that grows and a disk that is full (``test_maps``), two pages that
press Go (``test_driving``), a browser that reads nothing and a daemon's map of too many cells in a page (``test_feed``,
``tests/web``), a daemon that is started again and a proxy that cuts (``tests/ui``).
"""

import asyncio
import contextlib
import tracemalloc
from collections.abc import AsyncGenerator
from typing import Any

import aiohttp
import pytest
from yarl import URL

from robotd.client import Gap
from robotd.client.feed import Feed
from robotd.contract.plain import VERSION
from robotd.contract.topics import Frame, Topic, encode_frame
from robotd.core.errors import RemoteProtocolError, ServerError
from robotd.gateway.access.roles import Role
from robotd.gateway.access.sessions import Sessions
from robotd.gateway.access.tokens import Tokens, make_token
from robotd.gateway.browser.asked_by_page import request_of
from robotd.gateway.browser.console_protocol import StartMission, said
from robotd.gateway.feed.fan_out import FanOut
from robotd.gateway.feed.foxglove_channels import FoxgloveChannels
from robotd.gateway.feed.page_outbox import MOST_BYTES, PageOutbox
from robotd.gateway.feed.snapshot import Snapshot
from robotd.gateway.http import foxglove_socket
from tests.unit.gateway.rig import Opening
from tests.unit.gateway.test_feed import EMPTY, Ear, change, heard, message, read, whole
from tests.unit.gateway.test_foxglove import bearer

ODOMETRY = [message(Topic.ODOMETRY, "odometry", seq) for seq in range(1, 4)]
OF_LATER = encode_frame(Topic.ODOMETRY, "s", 9, {"event": "odometry"}).replace(b"\xa1v\x01", b"\xa1v\x02")


async def _no_map() -> Any:
    raise AssertionError("nobody asks for a map")


async def handed_on(*frames: bytes) -> list[int]:
    """The numbers of what is handed on of these, by a gateway that subscribes again whenever it has to."""
    fan, ear = FanOut(Snapshot(), _no_map), Ear()
    fan.join(ear)
    left = list(frames)

    async def subscription() -> AsyncGenerator[Frame | Gap, None]:
        feed = Feed()
        while left:
            for item in feed.sort(left.pop(0)):
                yield item
        await asyncio.Event().wait()

    following = asyncio.create_task(fan.follow(subscription))
    await asyncio.sleep(60.0)
    following.cancel()
    await asyncio.wait((following,))
    return [one.seq for one in ear.heard]


async def test_frames_that_are_cut_are_left_out() -> None:
    cuts = [ODOMETRY[1][:length] for length in range(0, len(ODOMETRY[1]), 5)]
    assert await handed_on(ODOMETRY[0], *cuts, ODOMETRY[2]) == [1, 3]


async def test_frames_that_come_twice_are_handed_on_once() -> None:
    assert await handed_on(*ODOMETRY, *ODOMETRY) == [1, 2, 3]


@pytest.mark.parametrize("foreign", [b"", b"GET / HTTP/1.1\r\n\r\n", b"odometry\0\x93\x01\x02\x03", bytes(range(256))])
async def test_frames_of_others_are_left_out(foreign: bytes) -> None:
    assert await handed_on(ODOMETRY[0], foreign, ODOMETRY[1]) == [1, 2]


async def test_frames_of_another_version_are_left_out_and_said(caplog: pytest.LogCaptureFixture) -> None:
    assert ODOMETRY[0] != OF_LATER
    assert await handed_on(ODOMETRY[0], OF_LATER, ODOMETRY[1]) == [1, 2]
    assert f"speaks version 2, this client {VERSION}" in caplog.text


def test_an_older_daemon_tells_less_and_is_understood() -> None:
    snapshot = Snapshot()
    # As it was before there were commanders, holds, and maps that nobody saved.
    told: dict[str, Any] = {"mode": "idle", "reason": "", "devices": [], "bumpers_rad": []}
    told |= dict.fromkeys(("battery_v", "mission_id", "map_id", "map_name", "recording"))
    snapshot.accept(read(message(Topic.STATUS, "status", 1, "s", **told)), 0)
    assert snapshot.status is not None
    assert (snapshot.status.commander, snapshot.status.held, snapshot.status.map_unsaved) == (None, None, False)


def test_what_a_later_daemon_tells_beside_is_handed_on_as_it_is() -> None:
    snapshot = Snapshot()
    snapshot.accept(heard(Topic.MISSION, "of_next_year", 1, much=[1, {"more": 2}]), 0)
    assert [read(frame).event for frame in snapshot.frames()] == ["of_next_year"]


def test_of_a_daemon_that_floods_a_page_has_a_bounded_rest() -> None:
    box = PageOutbox(list)
    frames = [
        *(heard(Topic.ODOMETRY, "odometry", seq) for seq in range(2000)),
        *(heard(Topic.LOG, "log", seq, message="x" * 200) for seq in range(2000)),
        *(change(seq, 3, 7) for seq in range(2000)),
    ]
    for frame in frames:
        box.put(frame)
    waiting = []
    while (item := box.take()) is not None:
        waiting.append(item)
    assert len(waiting) < 600
    assert sum(len(item) for item in waiting) < MOST_BYTES
    assert box.dropped > 3000


async def test_a_map_of_ten_milliards_of_cells_costs_nothing() -> None:
    fan, ear = FanOut(Snapshot(), _no_map), Ear()
    fan.join(ear)
    huge = {"rows": 100_000, "cols": 100_000}
    begun = whole(0, EMPTY).fields | huge
    keeping = asyncio.create_task(fan.keep_map())
    tracemalloc.start()
    try:
        fan.accept(heard(Topic.MAP, "map_changed", 0, **_without_envelope(begun)))
        for generation in range(1, 80):  # enough to be laid into the whole map, which cannot be
            fan.accept(
                heard(Topic.MAP, "map_changed", generation, **_without_envelope(change(generation, 0, 1).fields | huge))
            )
        await asyncio.sleep(1.0)
        with pytest.raises(RemoteProtocolError):
            FoxgloveChannels(0).take(Frame.of(heard(Topic.MAP, "map_changed", 0, **_without_envelope(begun)).data))
        assert tracemalloc.get_traced_memory()[1] < 8 << 20
    finally:
        tracemalloc.stop()
        keeping.cancel()
        await asyncio.wait((keeping,))
    fan.accept(heard(Topic.ODOMETRY, "odometry", 1))
    assert ear.heard[-1].event == "odometry", "it goes on"


def _without_envelope(fields: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if name not in {"v", "session", "seq", "event", "time_ns"}}


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", '"NaN"', "null", "1e300"])
def test_a_number_that_is_none_is_no_place(number: str) -> None:
    with pytest.raises(ServerError) as refused:
        _request_of(f'{{"type": "mission", "id": 1, "cmd": "drive_to", "args": {{"x_m": {number}, "y_m": 0}}}}')
    assert refused.value.code in {"malformed", "bad_argument"}


def _request_of(text: str) -> object:
    asked = said(text)
    assert isinstance(asked, StartMission)
    return request_of(asked.cmd, asked.args, Role.OPERATOR)


@pytest.mark.parametrize("name", ["../office", "..", "a/../b", "office/..", ".hidden", "a\0b", "x" * 65, ""])
def test_a_name_that_leads_elsewhere_is_no_map(name: str) -> None:
    for cmd, key in (("map_load", "name"), ("map_delete", "name"), ("map_save", "name"), ("map_start", "name")):
        with pytest.raises(ServerError, match="bad_argument"):
            request_of(cmd, {key: name}, Role.ADMIN)
    with pytest.raises(ServerError, match="bad_argument"):
        request_of("map_rename", {"name": "office", "new_name": name}, Role.ADMIN)


def test_a_clock_that_is_set_back_ends_no_session_and_revives_none() -> None:
    _, token = make_token("anna", Role.OPERATOR, 1e9)
    sessions = Sessions(3600.0)
    secret, session = sessions.begin(token, 1e9)
    assert sessions.find(secret, 1e9 - 86_400.0) is session
    assert session.seen_unix_s == 1e9
    assert sessions.end_revoked(Tokens((token,)), 1e9 - 86_400.0) == []
    sessions.end(session, 1e9)
    assert sessions.find(secret, 1e9 - 86_400.0) is None
    again = Sessions(3600.0)
    again.take(sessions.to_bytes(1e9 - 86_400.0))
    assert again.find(secret, 1e9 - 86_400.0) is None


@pytest.mark.real_clock
async def test_an_app_that_is_told_nothing_is_pinged_so_that_no_proxy_cuts_it(
    opening: Opening, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foxglove_socket, "_HEARTBEAT_S", 0.1)
    async with opening() as rig, aiohttp.ClientSession(rig.address) as session:
        headers = {"Authorization": bearer(rig)}
        async with session.ws_connect("foxglove", headers=headers, autoping=False) as socket:
            kinds = set()
            while aiohttp.WSMsgType.PING not in kinds:
                kinds.add((await socket.receive(20.0)).type)
        with contextlib.suppress(ConnectionError):
            await socket.close()


@pytest.mark.real_clock
async def test_cookies_of_another_robot_on_this_host_sign_nobody_in_and_hide_nothing(opening: Opening) -> None:
    below = {"X-Forwarded-Prefix": "/dusty"}
    async with opening(trusted_proxies=("127.0.0.1",)) as rig, aiohttp.ClientSession(rig.address) as session:
        # As a browser sends it: that of the robot at the root of this host, and ours, which is below a path.
        port = rig.address.port
        origin = {"Origin": str(rig.address.origin())}
        async with session.post("api/session", json={"token": rig.secrets["viewer"]}, headers=origin | below) as answer:
            made = answer.cookies
        assert [cookie["path"] for cookie in made.values()] == ["/dusty/"]
        ours = "; ".join(f"{name}={cookie.value}" for name, cookie in made.items())
        session.cookie_jar.clear()
        for others in (f"robotd_{port}=of-another-robot", f"robotd_{port}=of-another-robot; robotd_1={'x' * 43}"):
            for cookies, status in ((f"{ours}; {others}", 200), (f"{others}; {ours}", 200), (others, 401)):
                headers = {**origin, **below, "Cookie": cookies}
                async with session.get(URL(f"{rig.address}api/session"), headers=headers) as answer:
                    assert answer.status == status, cookies
