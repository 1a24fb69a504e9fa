"""What ends the daemon: signals, each of which stops the robot before anything else."""

import asyncio
import os
import signal
from collections.abc import Iterator

import pytest

from robotd.app.ending import Ending


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    before = signal.getsignal(signal.SIGHUP)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize(
    ("number", "exit_code"),
    [
        (signal.SIGTERM, 0),
        (signal.SIGINT, 0),
        (signal.SIGHUP, 0),
        (signal.SIGQUIT, 131),
        (signal.SIGABRT, 134),
        (signal.SIGUSR1, 138),
        (signal.SIGUSR2, 140),
        (signal.SIGALRM, 142),
        (signal.SIGTSTP, 148),
    ],
)
async def test_each_signal_stops_first_and_asks_for_the_end(number: signal.Signals, exit_code: int) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    stops: list[bool] = []
    ending = Ending(lambda: stops.append(ending.asked.is_set()))
    os.kill(os.getpid(), number)
    await ending.asked.wait()
    assert stops == [False]
    assert (ending.reason, ending.exit_code) == (number.name, exit_code)
    assert not ending.is_hastened


async def test_a_second_signal_stops_once_more_and_hastens() -> None:
    stops: list[str] = []

    async def ends_slowly() -> Ending:
        ending = Ending(lambda: stops.append("stop"))
        os.kill(os.getpid(), signal.SIGTERM)
        await ending.asked.wait()
        os.kill(os.getpid(), signal.SIGQUIT)
        try:
            await asyncio.sleep(10.0)
        except asyncio.CancelledError:
            return ending
        raise AssertionError("nothing hastened it")

    ending = await asyncio.create_task(ends_slowly())
    assert stops == ["stop", "stop"]
    assert ending.is_hastened
    assert (ending.reason, ending.exit_code) == ("SIGTERM", 0)


async def test_what_nohup_ignores_stays_ignored() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    ending = Ending(lambda: None)
    os.kill(os.getpid(), signal.SIGHUP)
    await asyncio.sleep(0.1)
    assert not ending.asked.is_set()
