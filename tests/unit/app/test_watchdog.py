"""What systemd is told, and that only a healthy loop feeds its watchdog."""

import asyncio
import errno
import os
import secrets
import socket
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from robotd.app.watchdog import Notifier, feed_watchdog, watchdog_s
from robotd.core.clock import VirtualClockLoop


@pytest.fixture(params=["path", "abstract"])
def manager(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[socket.socket, str]]:
    """A socket as systemd's, and its address as in ``NOTIFY_SOCKET``."""
    address = str(tmp_path / "notify") if request.param == "path" else f"@robotd-test-{secrets.token_hex(8)}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK) as listener:
        listener.bind(address.replace("@", "\0", 1) if address.startswith("@") else address)
        yield listener, address


def test_states_arrive_as_datagrams(manager: tuple[socket.socket, str]) -> None:
    listener, address = manager
    notifier = Notifier.of({"NOTIFY_SOCKET": address})
    notifier.ready()
    notifier.status("mapping: stop 3 of 9\nwith a second line")
    notifier.status("")
    notifier.feed()
    notifier.stopping()
    told = [listener.recv(200) for _ in range(5)]
    assert told == [b"READY=1", b"STATUS=mapping: stop 3 of 9", b"STATUS=", b"WATCHDOG=1", b"STOPPING=1"]


@pytest.mark.parametrize("environment", [{}, {"NOTIFY_SOCKET": ""}, {"NOTIFY_SOCKET": "/nowhere/at/all"}])
def test_where_nobody_listens_nothing_happens(environment: dict[str, str]) -> None:
    Notifier.of(environment).ready()


def test_a_manager_that_does_not_listen_holds_nobody_up(manager: tuple[socket.socket, str]) -> None:
    notifier = Notifier(manager[1])
    for _ in range(5000):
        notifier.feed()


@pytest.mark.parametrize("code", [errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM])
@pytest.mark.parametrize("call", ["socket", "sendto"])
def test_no_error_of_the_system_ends_who_notifies_and_it_is_said_once(
    call: str,
    code: int,
    manager: tuple[socket.socket, str],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    listener, address = manager
    notifier = Notifier(address)

    class Refused(socket.socket):
        def __init__(self, *arguments: int) -> None:
            if call == "socket":
                raise OSError(code, os.strerror(code))
            super().__init__(*arguments)

        def sendto(self, *_: object) -> int:
            raise OSError(code, os.strerror(code))

    with monkeypatch.context() as refusing:
        refusing.setattr(socket, "socket", Refused)
        notifier.feed()
        notifier.feed()
    assert len(caplog.messages) == 1
    assert os.strerror(code) in caplog.messages[0]
    notifier.feed()
    assert listener.recv(200) == b"WATCHDOG=1"


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, None),
        ({"WATCHDOG_USEC": "10000000"}, 10.0),
        ({"WATCHDOG_USEC": "10000000", "WATCHDOG_PID": str(os.getpid())}, 10.0),
        ({"WATCHDOG_USEC": "10000000", "WATCHDOG_PID": "1"}, None),
        ({"WATCHDOG_USEC": "0"}, None),
        ({"WATCHDOG_USEC": "soon"}, None),
    ],
)
def test_the_watchdog_is_wanted_as_the_environment_says(environment: dict[str, str], expected: float | None) -> None:
    assert watchdog_s(environment) == expected


class Manager(Notifier):
    """Notes when it was fed."""

    def __init__(self) -> None:
        super().__init__(None)
        self.fed_s: list[float] = []

    def feed(self) -> None:
        self.fed_s.append(asyncio.get_running_loop().time())

    def longest_wait_s(self, until_s: float) -> float:
        times = [0.0, *self.fed_s, until_s]
        return max(later - earlier for earlier, later in pairwise(times))


async def run_until(
    end_s: float, manager: Manager, healthy_after_s: float = 0.0, stalls: dict[float, float] | None = None
) -> None:
    """Feed a ten-second watchdog until then, with the loop stalled at these times for so long."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualClockLoop)
    feeding = asyncio.create_task(feed_watchdog(manager, 10.0, lambda: loop.time() >= healthy_after_s))
    for at_s, for_s in (stalls or {}).items():
        loop.call_at(at_s, loop._jump, for_s)
    await asyncio.sleep(end_s - loop.time())
    feeding.cancel()


async def test_a_healthy_loop_feeds_twice_in_time() -> None:
    manager = Manager()
    await run_until(60.0, manager)
    assert 10 <= len(manager.fed_s) <= 12
    assert manager.longest_wait_s(60.0) < 5.5


async def test_an_unhealthy_daemon_starves_the_watchdog() -> None:
    manager = Manager()
    await run_until(60.0, manager, healthy_after_s=1000.0)
    assert manager.fed_s == []


async def test_a_daemon_that_recovers_in_time_lives() -> None:
    manager = Manager()
    await run_until(60.0, manager, healthy_after_s=7.0)
    assert 7.0 <= manager.fed_s[0] < 10.0


async def test_one_short_stall_is_survived() -> None:
    manager = Manager()
    await run_until(30.0, manager, stalls={12.0: 2.0})
    assert manager.longest_wait_s(30.0) < 10.0


async def test_a_loop_that_stalls_again_and_again_starves_the_watchdog() -> None:
    manager = Manager()
    await run_until(60.0, manager, stalls={2.0 * number: 1.5 for number in range(1, 30)})
    assert manager.longest_wait_s(60.0) > 10.0
