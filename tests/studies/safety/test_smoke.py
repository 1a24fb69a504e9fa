"""A few trials of what ``make safety`` measures: every cause puts the stop on every wire of a real daemon."""

from importlib.util import find_spec

import pytest

from robotd.core.clock import NS_PER_S
from tests.studies.safety.run import measured, percentile
from tests.support.real_rig import ms_since
from tests.support.ways_to_end import CAUSES, ON_C_BOARDS

TRIALS = {"lease expiry": 4, "client killed": 1, "loop stall": 4, "SIGTERM": 1, "daemon killed": 1, ON_C_BOARDS: 1}
SOON_MS = 500.0
"""However busy the machine that runs the tests; how soon it really is, ``make safety`` says."""
needs_c = pytest.mark.skipif(
    find_spec("robotd.sim.firmware._native") is None, reason="there was no C compiler for the firmware"
)


@pytest.mark.real_clock
@pytest.mark.shares_descriptors  # the server that forks clients lives until the tests end
@pytest.mark.parametrize(
    "cause", [pytest.param(cause, marks=needs_c if cause == ON_C_BOARDS else ()) for cause in CAUSES]
)
async def test_the_stop_is_on_the_wires_soon(cause: str) -> None:
    late_ms = await measured(cause, TRIALS[cause])
    assert len(late_ms) == TRIALS[cause]
    assert max(late_ms) < SOON_MS


def test_percentiles_are_numbers_that_were_measured() -> None:
    assert [percentile([1.0, 2.0, 3.0, 4.0], share) for share in (0.25, 0.5, 0.51, 0.999)] == [1.0, 2.0, 3.0, 4.0]
    assert ms_since(0, NS_PER_S) == 1000.0
