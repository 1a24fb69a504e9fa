"""``make lag``: how late the daemon's event loop is, and how long one callback holds it, while the daemon works."""

import argparse
import asyncio
import contextlib
import os
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

from robotd.client import AsyncClient
from robotd.contract.events import MissionProgress
from robotd.contract.missions import Localize, MapStart, Mission, PriorHeading
from robotd.contract.topics import Topic
from robotd.core.clock import now_ns
from robotd.core.errors import RobotdError
from robotd.maps.store import MapStore
from tests.benchmarks.run import ROOT, commit
from tests.studies.lag.samples import Figures, Samples
from tests.studies.lag.workload import LARGE_CELLS, REGIONS, large_grid
from tests.support.real_rig import Rig, armed, give_precedence, rig
from tests.support.spinning import spinning
from tests.support.this_machine import processor

LEASE_S = 10.0
"""Longer than any stall: what is measured shall not end by it."""
NOTHING_KNOWN = Localize(heading=PriorHeading.UNKNOWN, tie=False)
HEADER = """\
| while | beside | lag p50 | lag p99.9 | lag max | callback p99.9 | callback max | over [s] |
|---|---|---|---|---|---|---|---|"""
NOW = "## Now\n"
PAGE = ROOT / "docs" / "benchmarks" / "loop-lag.md"

Work = Callable[[Rig, AsyncClient], Awaitable[None]]
Row = tuple[str, str, Figures]


async def make_map(rig: Rig, client: AsyncClient) -> None:
    """One stop of 300 readings, on a fresh map."""
    await carried_out(client, MapStart.of("room", (), rig.robot.start))


async def localize(rig: Rig, client: AsyncClient) -> None:
    """300 readings, every heading possible."""
    await carried_out(client, NOTHING_KNOWN)


async def load_and_show(rig: Rig, client: AsyncClient) -> None:
    """From the disk into use, to a reader of maps and to one who asks."""
    await client.map_load("large")
    await client.map_show()


async def save(rig: Rig, client: AsyncClient) -> None:
    """The same map, as a new version."""
    await client.map_save("copy")


async def carried_out(client: AsyncClient, mission: Mission) -> None:
    """Carry out a mission; one that a stall ended is begun again, twice at most."""
    for _ in range(3):
        await armed(client)
        progress = [one async for one in client.run_mission(mission, LEASE_S) if isinstance(one, MissionProgress)]
        if progress[-1].phase == "done":
            return
        print(f"  (again: {progress[-1].message})", flush=True)
    raise RobotdError(f"the mission does not come to its end: {progress[-1].message}")


PLAIN: dict[str, Work] = {
    "mapping": make_map,
    "localizing, nothing known": localize,
    f"loading and packing {LARGE_CELLS} x {LARGE_CELLS}": load_and_show,
    f"saving {LARGE_CELLS} x {LARGE_CELLS}": save,
}
WITH_REGIONS: dict[str, Work] = {"a map for the next": make_map, f"estimates of {REGIONS} large regions": localize}
"""The same road for every estimate, whatever the place: its answers are replaced."""


async def measured(directory: Path, beside: str, kind: str, works: dict[str, Work]) -> list[Row]:
    """Let one daemon do one piece of work after the other."""
    samples_file = directory / f"{beside}-{kind}.npz"
    times: dict[str, tuple[int, int]] = {}
    async with rig(directory / f"{beside}-{kind}") as it, _lived(it, kind, samples_file) as client:
        for name, work in works.items():
            began_ns = now_ns()
            await work(it, client)
            times[name] = began_ns, now_ns()
    samples = Samples.read(samples_file)
    return [(name, beside, samples.between(*times[name])) for name in works]


@contextlib.asynccontextmanager
async def _lived(it: Rig, kind: str, samples_file: Path) -> AsyncIterator[AsyncClient]:
    MapStore(it.directory / "maps").save("large", large_grid(), {}, 0)
    async with it.daemon(("-m", "tests.studies.lag.measured", kind, str(samples_file))) as process:
        async with AsyncClient(it.runtime_dir) as client:
            with client.subscribe(Topic.MAP, Topic.POSE):  # somebody reads what is published
                yield client
        process.terminate()
        await process.wait()


def tables(loads: list[str]) -> Iterator[Row]:
    """Measure everything, quiet first."""
    with tempfile.TemporaryDirectory(prefix="robotd-lag-") as directory:
        for beside in loads:
            with spinning(os.cpu_count() or 1) if beside == "busy" else contextlib.nullcontext():
                for kind, works in (("plain", PLAIN), ("regions", WITH_REGIONS)):
                    rows = asyncio.run(measured(Path(directory), beside, kind, works))
                    yield from (row for row in rows if row[0] != "a map for the next")


def introduction() -> str:
    """Return where and how this was measured."""
    return (
        f"Commit {commit()}, {datetime.now(UTC):%Y-%m-%d}; {processor()}, {os.cpu_count()} processors, load"
        f" {os.getloadavg()[0]:.1f} before. Times in ms."
    )


def write_page(file: Path, table: str) -> None:
    """Write the table in place of the one that the page ends with; what was measured before stays."""
    kept, _, _ = file.read_text(encoding="utf-8").partition(NOW)
    file.write_text(f"{kept}{NOW}\n{table}\n", encoding="utf-8")
    print(f"written to {file}")


def main() -> None:
    """Print the table, and write it where it is told to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=("quiet", "busy"), help="one kind of neighbours (default: both)")
    parser.add_argument(
        "--out", type=Path, default=PAGE, help="page whose last section it writes (default: %(default)s)"
    )
    arguments = parser.parse_args()
    loads = [arguments.only] if arguments.only else ["quiet", "busy"]
    lines = [introduction(), "", *HEADER.splitlines()]
    print("\n".join(lines), flush=True)
    give_precedence(os.getpid())  # the boards, which stand for machines of their own, live here
    for name, beside, figures in tables(loads):
        lines.append(figures.row(name, beside))
        print(lines[-1], flush=True)
    if not arguments.only:
        write_page(arguments.out, "\n".join(lines))


if __name__ == "__main__":
    main()
