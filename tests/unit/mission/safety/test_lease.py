"""A lease runs out unless it is renewed."""

import asyncio

from robotd.core.clock import NS_PER_S, now_ns
from robotd.mission.safety.lease import Lease


async def test_it_runs_out_when_it_says() -> None:
    expired: list[int] = []
    Lease(0.5, lambda: expired.append(now_ns()))
    await asyncio.sleep(2.0)
    assert [round(at / NS_PER_S, 3) for at in expired] == [0.5]


async def test_renewing_keeps_it_alive_and_silence_ends_it() -> None:
    expired: list[int] = []
    lease = Lease(0.5, lambda: expired.append(now_ns()))
    for _ in range(10):
        await asyncio.sleep(0.4)
        lease.renew()
    assert expired == []
    await asyncio.sleep(1.0)
    assert [round(at / NS_PER_S, 3) for at in expired] == [4.5]


async def test_a_lease_given_back_never_runs_out() -> None:
    expired: list[int] = []
    Lease(0.5, lambda: expired.append(now_ns())).end()
    await asyncio.sleep(2.0)
    assert expired == []
