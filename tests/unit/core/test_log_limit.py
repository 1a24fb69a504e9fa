"""A flood of lines becomes a few, and the count of the others."""

import asyncio

from robotd.core.log_limit import LogLimit


async def test_a_burst_passes_then_one_in_a_while_with_the_count_of_the_others() -> None:
    limit = LogLimit(burst=3, every_s=10.0)
    assert [limit.line("x") for _ in range(5)] == ["x", "x", "x", None, None]
    await asyncio.sleep(9)
    assert limit.line("x") is None
    await asyncio.sleep(2)
    assert limit.line("x") == "x (3 more like it were not logged)"
    await asyncio.sleep(100)
    assert [limit.line("x") for _ in range(4)] == ["x", "x", "x", None]
