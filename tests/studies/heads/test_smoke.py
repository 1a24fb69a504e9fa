"""Two trials of what ``make heads`` does two hundred times: a real head is killed, and nothing is lost."""

import random
from pathlib import Path

import pytest

from tests.studies.heads.trial import subject


@pytest.mark.real_clock
async def test_a_killed_head_of_a_real_daemon_is_followed_by_another_that_has_the_map(tmp_path: Path) -> None:
    async with subject(tmp_path) as one:
        for state in ("idle", "localizing"):
            outcome = await one.trial(state, "kill -9", random.Random(3))
            assert outcome.wrong == ""
