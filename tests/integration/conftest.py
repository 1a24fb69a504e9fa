"""How integration tests come by a living daemon."""

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from functools import partial
from pathlib import Path

import pytest

from tests.support.living import Living, living

Live = Callable[..., AbstractAsyncContextManager[Living]]


@pytest.fixture
def live(tmp_path: Path) -> Live:
    """How to bring a daemon to life on an emulated robot: ``async with live(robot) as it``."""
    return partial(living, tmp_path)
