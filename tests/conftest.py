"""Rules that hold for every test: virtual time, no leaked task, no leaked descriptor."""

import asyncio
import gc
import inspect
import os
import signal
import tempfile
import threading
from collections.abc import Generator, Iterator
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from robotd.core.clock import VirtualClockLoop
from tests.property_cases import (  # noqa: F401  # hooks: pytest finds them here
    pytest_runtest_call,
    pytest_runtest_logreport,
    pytest_terminal_summary,
)

settings.register_profile(
    "house",
    deadline=None,  # how long an example takes is the machine's business
    derandomize="CI" in os.environ,  # what lands must not depend on luck; everybody else keeps looking
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("house")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in what a script puts in the background, and its children
    signal.signal(signal.SIGINT, signal.default_int_handler)

_TEST_FILES = f"{tempfile.gettempdir()}/pytest-of-"
"""Where ``tmp_path`` is; libraries may keep files of their own open elsewhere."""
DATA_DIR = Path(os.environ.get("ROBOTD_DATA", Path(__file__).parents[2] / "shared" / "data"))


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep the modules and tests that are collected out of every later look for garbage: they stay to the end."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long or waits for real time: at the end it would keep one worker busy, and none else."""
    items.sort(key=lambda item: -sum(item.get_closest_marker(name) is not None for name in ("slow", "real_clock")))


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run ``async def`` tests on a virtual clock, or on the real one if marked ``real_clock``."""
    if not inspect.iscoroutinefunction(pyfuncitem.obj):
        return None
    factory = None if pyfuncitem.get_closest_marker("real_clock") else VirtualClockLoop
    wanted = inspect.signature(pyfuncitem.obj).parameters
    arguments = {name: value for name, value in pyfuncitem.funcargs.items() if name in wanted}
    with asyncio.Runner(loop_factory=factory) as runner:
        runner.run(_without_leaked_tasks(pyfuncitem.obj, arguments))
    return True


async def _without_leaked_tasks(test: Any, arguments: dict[str, Any]) -> None:
    await test(**arguments)
    for _ in range(3):  # cancelled tasks need a turn or two to end
        await asyncio.sleep(0)
    leaked = [task for task in asyncio.all_tasks() if task is not asyncio.current_task() and not task.done()]
    if leaked:
        pytest.fail("tasks left running: " + ", ".join(str(task.get_coro()) for task in leaked))


@pytest.fixture(autouse=True)
def _no_leaked_descriptors(request: pytest.FixtureRequest) -> Iterator[None]:
    if request.node.get_closest_marker("shares_descriptors"):
        yield
        return
    before = _open_descriptors()
    yield
    if _open_descriptors() - before:
        gc.collect()  # reference cycles may still hold what the test let go
        _let_watchers_end()
    leaked = dict(_open_descriptors() - before)
    if leaked:
        pytest.fail(f"descriptors left open: {leaked}")


def _let_watchers_end() -> None:
    """Threads that watched a line end soon after it was closed, and close what rang them."""
    for thread in threading.enumerate():
        if thread.name.startswith("watch "):
            thread.join(5.0)


def _open_descriptors() -> set[tuple[str, str]]:
    found = set()
    for number in os.listdir("/proc/self/fd"):  # noqa: PTH208  # twice for each of ten thousand tests
        try:
            target = os.readlink(f"/proc/self/fd/{number}")  # noqa: PTH115  # as above
        except OSError:
            continue
        if target.startswith(("/dev/pts", "/dev/ptmx", "socket:", "pipe:", _TEST_FILES, "anon_inode:[event")):
            found.add((number, target))
    return found


@pytest.fixture(scope="session")
def laser_data() -> Path:
    """The folder of recorded laser logs; the test is skipped, saying so, where there is none."""
    if not (DATA_DIR / "intel").is_dir():
        pytest.skip(f"no recorded laser logs at {DATA_DIR}: set ROBOTD_DATA to the folder that holds intel/ and fr079/")
    return DATA_DIR


@pytest.fixture
def no_tracker_is_left() -> Iterator[None]:
    """End what a pool of processes starts beside itself, which would outlive the test with its pipe."""
    yield
    resource_tracker._resource_tracker._stop()  # type: ignore[attr-defined]  # there is no public way
