"""``robotd-gateway`` as a process: it begins with a token alone, and what ends it ends the missions of its pages."""

import asyncio
import contextlib
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import aiohttp
import pytest

from robotd.cli.main import main as robotctl
from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import TokenFile, Tokens, make_token
from robotd.gateway.command.kept_missions import Missions
from robotd.gateway.composed import run as run_gateway
from robotd.gateway.house import NO_TOKEN
from robotd.gateway.program import read_settings
from tests.support.console_page import PATIENCE_S, page_of, until
from tests.unit.server.conftest import Serving

SHIPPED = Path(__file__).parents[3] / "systemd" / "robotd-gateway.toml"


def written(directory: Path, text: str = "") -> Path:
    file = directory / "robotd-gateway.toml"
    file.write_text(
        f'[listen]\nport = 0\n[robot]\nruntime_dir = "{directory}"\n[access]\nstate_dir = "{directory}/state"\n{text}'
    )
    return file


def run(*arguments: str) -> tuple[int, str]:
    done = subprocess.run(
        (sys.executable, "-m", "robotd.gateway.program", *arguments), capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_without_a_token_it_ends_with_78_and_says_how_to_make_one(tmp_path: Path) -> None:
    code, said = run("--config", str(written(tmp_path)))
    assert code == 78
    assert said == f"robotd-gateway: {NO_TOKEN}\n"
    assert "robotctl gateway token new NAME --role operator" in said


def test_every_mistake_in_its_settings_is_named_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "robotd-gateway.toml"
    file.write_text('[listen]\nhost = "0.0.0.0"\n[watching]\npatience_s = 9\nunatended = true\n')
    code, said = run("--check", "--config", str(file))
    assert code == 78
    assert f"{file}:2: listen.host: is heard by others" in said or f"{file}:2: listen.host: 0.0.0.0 is heard" in said
    assert f"{file}:4: watching.patience_s: must be 0.5 to 5 s" in said
    assert f"{file}:5: watching.unatended: unknown key; did you mean unattended?" in said


def test_the_shipped_settings_are_the_defaults() -> None:
    assert read_settings(SHIPPED) == read_settings(None)


def test_robotctl_makes_lists_and_revokes_tokens(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = ["--config", str(written(tmp_path))]
    assert robotctl(["gateway", "token", "new", "anna", "--role", "operator", *config]) == 0
    secret = capsys.readouterr().out.split()[0].partition("#")[2]
    tokens = TokenFile(tmp_path / "state" / "tokens.json").read()
    found = tokens.match(secret, 0.0)
    assert found is not None
    assert (found.name, found.role) == ("anna", Role.OPERATOR)
    assert robotctl(["gateway", "token", "new", "anna", *config]) == 1
    assert robotctl(["gateway", "token", "list", *config]) == 0
    assert "anna" in capsys.readouterr().out
    assert robotctl(["gateway", "token", "revoke", "anna", *config]) == 0
    assert TokenFile(tmp_path / "state" / "tokens.json").read() == Tokens()


@contextlib.asynccontextmanager
async def process_of(directory: Path) -> AsyncIterator[tuple[asyncio.subprocess.Process, str, str]]:
    """A gateway's process, where it serves, and a secret of an operator."""
    secret, token = make_token("anna", Role.OPERATOR, 0.0)
    TokenFile(directory / "state" / "tokens.json").write(Tokens((token,)))
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "robotd.gateway.program", "--config", str(written(directory))),
        stderr=asyncio.subprocess.PIPE,
    )
    try:
        assert process.stderr is not None
        async with asyncio.timeout(60.0):
            said = (await process.stderr.readline()).decode()
        yield process, said.split()[-1], secret
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.communicate()


@pytest.mark.real_clock
@pytest.mark.parametrize(
    ("ending", "why"),
    [
        (signal.SIGKILL, "lease expired"),
        (signal.SIGSTOP, "lease expired"),
        (signal.SIGTERM, "anna, who drove, has left the console"),
    ],
)
async def test_whatever_ends_the_gateway_ends_the_missions_of_its_pages(
    tmp_path: Path, serving: Serving, ending: signal.Signals, why: str
) -> None:
    async with serving() as control, process_of(tmp_path) as (process, address, secret):
        jar = aiohttp.CookieJar(unsafe=True)
        headers = {"Origin": address.rstrip("/")}
        async with aiohttp.ClientSession(address, headers=headers, cookie_jar=jar) as session:
            async with session.post("api/session", json={"token": secret}) as answer:
                assert answer.status == 200
            async with page_of(session) as page:
                await page.until(lambda: any(frame.startswith(b"\x01status\0") for frame in page.frames))
                assert (await page.ask("command", cmd="arm"))["type"] == "result"
                control.release.clear()
                assert (await page.ask("mission", cmd="localize"))["type"] == "result"
                await asyncio.sleep(1.5)  # three leases
                assert control.is_busy
                process.send_signal(ending)
                began_s = asyncio.get_running_loop().time()
                await until(lambda: not control.is_busy)
                took_s = asyncio.get_running_loop().time() - began_s
                print(f"{ending.name}: the mission had ended after {took_s:.2f} s")
                with contextlib.suppress(ProcessLookupError):
                    process.send_signal(signal.SIGCONT)
                assert control._stop_reason == why
                assert took_s < PATIENCE_S


@pytest.mark.real_clock
async def test_a_gateway_of_which_a_duty_fails_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Else pages would be served, and nobody would watch over their missions."""

    async def broken(self: Missions) -> None:
        raise RuntimeError("a bug in the gateway")

    monkeypatch.setattr(Missions, "watch", broken)
    _, token = make_token("anna", Role.OPERATOR, 0.0)
    TokenFile(tmp_path / "state" / "tokens.json").write(Tokens((token,)))
    with pytest.raises(RuntimeError, match="a bug in the gateway"):
        await run_gateway(read_settings(written(tmp_path)), lambda _: None)
