"""A gateway before a daemon's front, as browsers and programs see it: real sockets on loopback."""

import asyncio
import contextlib
from pathlib import Path

import aiohttp
import pytest
from prometheus_client.openmetrics.parser import text_string_to_metric_families as openmetrics_families
from prometheus_client.parser import text_string_to_metric_families
from yarl import URL

from robotd.contract.events import RankMap
from robotd.core.errors import ConfigError
from robotd.gateway.access.visitor_limits import WRONG_TOKENS
from robotd.gateway.composed import gateway
from robotd.gateway.http.routes import ROUTES, openapi
from robotd.gateway.settings import AccessSettings, GatewaySettings, ListenSettings
from tests.support.console_page import PATIENCE_S, page_of, until
from tests.unit.gateway.rig import Opening

pytestmark = pytest.mark.real_clock


async def test_without_a_token_there_is_no_gateway(tmp_path: Path) -> None:
    settings = GatewaySettings(ListenSettings(port=0), access=AccessSettings(state_dir=str(tmp_path)))
    with pytest.raises(ConfigError, match="robotctl gateway token new NAME --role operator"):
        async with gateway(settings):
            pass


async def test_a_page_is_greeted_told_and_asked(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        hello = page.last("hello")
        assert hello is not None
        assert (hello["robot"], hello["role"], hello["name"]) == ("dusty", "operator", "some operator")
        await page.until(lambda: any(frame.startswith(b"\x01status\0") for frame in page.frames))
        await page.until(lambda: sum(one["type"] == "question" for one in page.texts) >= 3)
        assert page.last("commander") == {"type": "commander", "commander": None, "wish": None, "wish_left_s": None}


async def test_stop_by_socket_by_post_by_form_and_by_a_broken_message(opening: Opening) -> None:
    async with opening() as rig, rig.browser("viewer") as session, page_of(session) as page:
        answer = await page.ask("stop")
        assert answer["type"] == "stopped"
        assert 0.0 < answer["took_ms"] < 3000.0
        async with session.post("api/stop") as by_post:
            assert (await by_post.json())["took_ms"] > 0.0
        async with session.post("stop") as by_form:
            assert "STOPPED in" in await by_form.text()
        await page.socket.send_str('{"type": "stop", "id": ')
        await page.until(lambda: [one for one in page.texts if one["type"] == "stopped" and one["id"] == 0])
        assert rig.control.calls == ["stop: STOP by some viewer"] * 4


async def test_a_session_that_ended_may_still_stop_and_nothing_else(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session:
        async with session.delete("api/session") as out:
            assert out.status == 204
        async with session.get("api/state") as state:
            assert (state.status, (await state.json())["code"]) == (401, "not_signed_in")
        async with session.post("api/stop") as stop:
            assert stop.status == 200


async def test_a_stop_is_answered_while_a_command_hangs(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        rig.control.arming.clear()
        for _ in range(8):
            await page.socket.send_json({"type": "command", "id": 900, "cmd": "arm"})
        busy = await page.ask("command", cmd="status")
        assert busy["code"] == "busy"
        answer = await page.ask("stop")
        assert answer["type"] == "stopped"
        rig.control.arming.set()


async def test_a_mission_of_a_page_is_kept_and_its_end_told(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        assert (await page.ask("mission", cmd="localize"))["message"] == "not now"
        assert (await page.ask("command", cmd="arm"))["type"] == "result"
        rig.control.release.clear()
        started = await page.ask("mission", cmd="localize")
        assert started["result"]["mission_id"] == 1
        commander = await page.until(lambda: (page.last("commander") or {}).get("commander"))
        assert commander["driver"]["who"] == "some operator"
        await asyncio.sleep(3 * started["result"]["lease_s"])
        assert rig.control.is_busy, "its lease was renewed"
        rig.control.release.set()
        await page.until(lambda: (page.last("commander") or {}).get("commander", 0) is None)


async def test_a_page_that_hangs_ends_its_mission(opening: Opening) -> None:
    async with opening(patience_s=0.5) as rig, rig.browser() as session, page_of(session) as page:
        await page.ask("command", cmd="arm")
        rig.control.release.clear()
        await page.ask("mission", cmd="localize")
        page.is_hung = True
        await asyncio.wait_for(rig.control.halted.wait(), PATIENCE_S)
        assert "the page of some operator, who drove, has not answered for" in rig.control.calls[-1]


async def test_a_page_that_closes_ends_its_mission(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session:
        async with page_of(session) as page:
            await page.ask("command", cmd="arm")
            rig.control.release.clear()
            await page.ask("mission", cmd="localize")
        await asyncio.wait_for(rig.control.halted.wait(), PATIENCE_S)
        assert rig.control.calls[-1] == "stop: some operator, who drove, has left the console"


async def test_unattended_missions_are_off_unless_allowed(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        await page.ask("command", cmd="arm")
        answer = await page.ask("mission", cmd="localize", attended=False)
        assert answer["code"] == "refused"
        assert "watching.unattended" in answer["message"]
        assert not rig.control.is_busy


async def test_a_viewer_looks_and_an_operator_does(opening: Opening) -> None:
    async with opening() as rig, rig.browser("viewer") as session, page_of(session) as page:
        assert (await page.ask("command", cmd="status"))["type"] == "result"
        for kind, cmd in (("command", "arm"), ("mission", "localize"), ("command", "map_save")):
            assert (await page.ask(kind, cmd=cmd, **({"args": {"name": "a"}} if cmd == "map_save" else {})))[
                "code"
            ] == "not_allowed"
        assert (await page.ask("take_over"))["code"] == "not_allowed"
        async with session.get("api/access") as access:
            assert access.status == 403
        assert rig.control.calls == []


async def test_a_program_with_a_token_asks_without_a_page(opening: Opening) -> None:
    async with opening() as rig, aiohttp.ClientSession(rig.address) as session:
        bearer = {"Authorization": f"Bearer {rig.secrets['operator']}"}
        async with session.post("api/command/arm", json={}, headers=bearer) as answer:
            assert (answer.status, await answer.json()) == (200, {})
        async with session.post("api/command/localize", json={}, headers=bearer) as answer:
            assert (answer.status, (await answer.json())["code"]) == (409, "refused")
        async with session.post("api/command/renew", json={"mission_id": 1}, headers=bearer) as answer:
            assert answer.status == 404
        async with session.get("api/state", headers=bearer) as answer:
            assert (await answer.json())["events"]["status"]["reason"] == "fake"
        async with session.post("api/stop", headers=bearer) as answer:
            assert answer.status == 200


@pytest.mark.parametrize(
    ("headers", "code"),
    [
        ({"Host": "evil.example"}, "wrong_host"),
        ({"Origin": "http://evil.example"}, "wrong_origin"),
        ({"Sec-Fetch-Site": "cross-site"}, "wrong_origin"),
    ],
)
async def test_a_strange_page_or_name_gets_nothing(opening: Opening, headers: dict[str, str], code: str) -> None:
    async with opening() as rig, rig.browser() as session:
        async with session.post("api/command/arm", json={}, headers=headers) as answer:
            assert (await answer.json())["code"] == code
        async with session.get(
            "api/ws", headers={**headers, "Connection": "Upgrade", "Upgrade": "websocket"}
        ) as answer:
            assert (await answer.json())["code"] == code
        assert rig.control.calls == []


async def test_wrong_tokens_are_counted_and_then_even_a_right_one_waits(opening: Opening) -> None:
    async with opening() as rig, aiohttp.ClientSession(rig.address, headers=rig.origin) as session:
        for _ in range(WRONG_TOKENS):
            async with session.post("api/session", json={"token": "x" * 43}) as answer:
                assert (await answer.json())["code"] == "wrong_token"
        async with session.post("api/session", json={"token": rig.secrets["admin"]}) as answer:
            assert (answer.status, (await answer.json())["code"]) == (429, "too_many_tries")


async def test_a_revoked_token_hangs_up_on_its_pages(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        file = rig.house.token_file
        file.write(file.read().without("some operator"))
        await until(lambda: page.socket.closed)
        async with session.get("api/state") as state:
            assert state.status == 401


@pytest.mark.parametrize("data", [b"bytes", "x" * 70_000, "{}", '{"type": "answer", "n": 1, "more": 2}'])
async def test_a_page_that_says_strange_things_is_refused_or_hung_up_on(opening: Opening, data: bytes | str) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        await (page.socket.send_bytes(data) if isinstance(data, bytes) else page.socket.send_str(data))
        await until(lambda: page.socket.closed or page.last("problem"))
    assert rig.control.calls == []


async def test_a_page_that_says_too_much_is_hung_up_on_but_never_for_stops(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, page_of(session) as page:
        for _ in range(60):
            await page.socket.send_json({"type": "stop", "id": 5})
        await page.until(lambda: sum(one["type"] == "stopped" for one in page.texts) == 60)
        assert not page.socket.closed
        with contextlib.suppress(ConnectionError):
            for _ in range(60):
                await page.socket.send_json({"type": "answer", "n": 0})
        await until(lambda: page.socket.closed)


async def test_one_pages_driver_is_anothers_to_take_over(opening: Opening) -> None:
    async with contextlib.AsyncExitStack() as stack:
        rig = await stack.enter_async_context(opening())
        driving, watching = [
            await stack.enter_async_context(page_of(await stack.enter_async_context(rig.browser(role))))
            for role in ("operator", "admin")
        ]
        assert (await watching.ask("take_over"))["code"] == "refused"
        await driving.ask("command", cmd="arm")
        rig.control.release.clear()
        await driving.ask("mission", cmd="localize")
        assert (await watching.ask("mission", cmd="localize"))["message"].startswith("some operator drives already")
        assert (await watching.ask("take_over"))["type"] == "result"
        wish = await driving.until(lambda: (driving.last("commander") or {}).get("wish"))
        assert wish["who"] == "some admin"
        await driving.ask("hand_over", give=True)
        await watching.until(
            lambda: (
                ((watching.last("commander") or {}).get("commander") or {}).get("driver", {}).get("who") == "some admin"
            )
        )
        await driving.socket.close()
        await asyncio.sleep(0.2)
        assert rig.control.is_busy, "who gave it away may leave"
        rig.control.release.set()


async def test_every_answer_says_what_a_browser_may_not_do(opening: Opening) -> None:
    async with opening() as rig, rig.browser("admin") as session:
        for path in ("healthz", "readyz", "api/state", "api/audit", "api/access", "api/recordings", "no/such/place"):
            async with session.get(path) as answer:
                assert answer.headers["Content-Security-Policy"].startswith("default-src 'none'"), path
                assert "unsafe" not in answer.headers["Content-Security-Policy"]
                assert answer.headers["X-Content-Type-Options"] == "nosniff"
        async with session.get("no/such/place") as answer:
            assert await answer.json() == {"code": "not_found", "message": "Not Found", "where": "/no/such/place"}


@pytest.mark.parametrize(
    "name", ["..%2Ftokens.json", "%2e%2e%2f%2e%2e%2fetc%2fpasswd", "a.mcap", "link.mcap", ".hidden.mcap", "x"]
)
async def test_only_recordings_that_are_listed_are_sent(opening: Opening, tmp_path: Path, name: str) -> None:
    async with opening() as rig, rig.browser("viewer") as session:
        (tmp_path / "recordings" / "good.mcap").write_bytes(b"0123456789")
        (tmp_path / "recordings" / ".hidden.mcap").write_bytes(b"secret")
        (tmp_path / "recordings" / "link.mcap").symlink_to(rig.house.token_file.path)
        async with session.get(URL(f"{rig.address}api/recordings/{name}", encoded=True)) as answer:
            assert answer.status == 404
        async with session.get("api/recordings") as listed:
            assert [one["name"] for one in (await listed.json())["recordings"]] == ["good.mcap"]
        async with session.get("api/recordings/good.mcap", headers={"Range": "bytes=3-5"}) as answer:
            assert (answer.status, await answer.read()) == (206, b"345")


def test_the_description_has_every_address() -> None:
    paths = openapi()["paths"]
    assert {(path, method) for path, methods in paths.items() for method in methods} == {
        (route.path, route.method.lower()) for route in ROUTES
    }


async def test_metrics_parse_have_no_free_text_and_need_a_token(opening: Opening) -> None:
    async with opening() as rig, aiohttp.ClientSession(rig.address) as session:
        async with session.get("metrics") as answer:
            assert answer.status == 401
        bearer = {"Authorization": f"Bearer {rig.secrets['viewer']}"}
        async with session.post("api/stop", headers=bearer) as answer:
            assert answer.status == 200
        async with session.get("metrics", headers=bearer) as answer:
            told = text_string_to_metric_families(await answer.text())
            found = {family.name: family for family in told}
        accept = {"Accept": "application/openmetrics-text; version=1.0.0"}
        async with session.get("metrics", headers={**bearer, **accept}) as answer:
            assert answer.content_type == "application/openmetrics-text"
            assert list(openmetrics_families(await answer.text()))  # type: ignore[no-untyped-call]  # of others
    assert all(name.startswith("robotd_") and family.documentation.endswith(".") for name, family in found.items())
    samples = [sample for family in found.values() for sample in family.samples]
    assert 20 < len(samples) < 1000
    assert {value for sample in samples for value in sample.labels.values() if " " in value} == set()
    values = {sample.name: sample.value for sample in samples if not sample.labels}
    assert values["robotd_up"] == 1.0
    assert values["robotd_battery_volts"] == 24.5
    frames = next(sample for sample in samples if sample.name == "robotd_line_frames_total")
    assert (frames.labels, frames.value) == ({"line": "drive"}, 7.0)
    assert [one.value for one in found["robotd_gateway_stops"].samples if one.labels == {"confirmed": "yes"}] == [1.0]


async def test_the_heat_map_is_told_to_who_looks_at_it_and_asked_for_only_then(opening: Opening) -> None:
    heat = RankMap(1, "m", 0, 3, 300, 300, 1, 0.05, 0.0, 0.0, 2, 2, b"zlib")
    async with opening() as rig, rig.browser() as session, page_of(session) as page, page_of(session) as other:
        assert not rig.house.services.fan.wants_rank
        await page.socket.send_json({"type": "look", "rank": True})
        await until(lambda: rig.house.services.fan.wants_rank)

        def is_told() -> bool:
            rig.control.events.publish(heat)
            return any(frame.startswith(b"\x01rank\0") for frame in page.frames)

        await until(is_told)
        assert not any(frame.startswith(b"\x01rank\0") for frame in other.frames)
        await page.socket.send_json({"type": "look", "rank": False})
        await until(lambda: not rig.house.services.fan.wants_rank)
