"""``make load``: two hundred browsers, ten of them stalled and one hostile; fails if the others notice."""

import argparse
import asyncio
import os
import sys

from tests.studies.console.measured import Cost, CrowdSeen, house, with_crowd
from tests.support.real_rig import armed

_WORSE = 1.5
"""By what the others' p95 may differ: two runs of the same differ by as much."""
_SLACK_MS = 10.0
_GROWN_MIB = 8.0


async def measured(pages: int, seconds: float) -> tuple[tuple[CrowdSeen, Cost], tuple[CrowdSeen, Cost]]:
    """Return what well-behaved pages alone saw and cost, and the same with ten stalled and a hostile one among them."""
    async with house() as it:
        await armed(it.client)  # or there is less to tell
        alone = await with_crowd(it, pages - 11, seconds)
        together = await with_crowd(it, pages, seconds, stalled=10, hostile=1)
        return alone, together


def main() -> int:
    """Measure and print; 1 if it was too much."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pages", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60.0)
    arguments = parser.parse_args()
    load = os.getloadavg()[0]
    print(f"{os.cpu_count()} processors; load of others: {load:.1f} over the last minute; browsers on loopback")
    alone, together = asyncio.run(measured(arguments.pages, arguments.seconds))
    print(
        f"{'':34}{'read':>6}{'p50':>8}{'p95':>8}{'kB/s':>7}{'hung up':>9}"
        f"{'gateway':>9}{'MiB':>7}{'grew':>7}{'daemon':>8}"
    )
    _print("well-behaved alone", arguments.pages - 11, *alone)
    _print("with 10 stalled and 1 hostile", arguments.pages - 11, *together)
    print(
        "p50, p95: from the robot's own time of its odometry to its arrival at those that read [ms];"
        " gateway, daemon: shares of a processor"
    )
    worse = together[0].p95_ms > _WORSE * alone[0].p95_ms + _SLACK_MS
    lost = alone[0].hung_up or together[0].hung_up
    return int(bool(worse or lost or together[1].gateway_mib_more > _GROWN_MIB))


def _print(name: str, reading: int, seen: CrowdSeen, cost: Cost) -> None:
    print(
        f"{name:34}{reading:6}{seen.p50_ms:8.1f}{seen.p95_ms:8.1f}{seen.bytes_per_s / 1000:7.1f}{seen.hung_up:9}"
        f"{cost.gateway_share:9.1%}{cost.gateway_mib:7.1f}{cost.gateway_mib_more:+7.1f}{cost.daemon_share:8.1%}",
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
