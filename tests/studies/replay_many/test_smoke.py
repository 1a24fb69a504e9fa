"""A few random sessions: none replays to anything else."""

from pathlib import Path

import pytest

from tests.studies.replay_many.real import run_real_session
from tests.studies.replay_many.session import VENDOR_ROBOTS, run_session

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [3, 14, 18, 194, 1098])
def test_a_random_session_replays(seed: int) -> None:
    outcome = run_session(seed, actions=12)
    assert outcome.differs is None, (
        f"python -m tests.studies.replay_many.run --count 1 --seed {seed} after {outcome.done}"
    )
    assert outcome.results > 0


@pytest.mark.parametrize(("seed", "robot"), [(23, 1), (5, 4), (1, 0), (2, 2)])
def test_a_random_session_of_vendor_devices_replays(seed: int, robot: int) -> None:
    outcome = run_session(seed, 12, VENDOR_ROBOTS[robot])
    assert outcome.differs is None, f"seed {seed} of robot {robot} after {outcome.done}"
    assert outcome.results > 0


@pytest.mark.real_clock
def test_a_real_session_replays(tmp_path: Path) -> None:
    """A mission, and nothing beside it: more, and beside busy programs, is for ``make replay-many``."""
    outcome = run_real_session(26, actions=1, kept=tmp_path)
    assert outcome.differs is None, f"{outcome.kept} after {outcome.done}"
    assert outcome.results > 0
