"""``make heart``: whether a stop is on the wires in time, whatever clients do, and whatever becomes of the front."""

import argparse
import asyncio
import contextlib
import os
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.studies.heart.attackers import ATTACKERS
from tests.studies.heart.endings import MODES, Ended, end_front
from tests.studies.heart.trials import Suffered, suffer, with_a_large_map
from tests.studies.lag.samples import Samples
from tests.studies.safety.run import _precedence, percentile
from tests.support.real_rig import rig
from tests.support.spinning import spinning

STOP_MS = 50.0
LAG_MS = {"quiet": 5.0, "busy": 20.0}
MEMORY_MIB = 300.0
AWAY_MS = 1000.0
_BETWEEN_S = 1.1
"""A front that lived so long is followed at once by the next one."""


def main() -> None:
    """Measure and print; fail if a bound does not hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=100, help="of each attack (default: %(default)s)")
    parser.add_argument("--endings", type=int, default=50, help="of the front in each mode (default: %(default)s)")
    parser.add_argument("--only", choices=(*ATTACKERS, "endings"), help="one row (default: all)")
    parser.add_argument("--beside", choices=("quiet", "busy"), help="one kind of neighbours (default: both)")
    arguments = parser.parse_args()
    print(f"{os.cpu_count()} processors; others' load {os.getloadavg()[0]:.1f} before", flush=True)
    failed = []
    for beside in [arguments.beside] if arguments.beside else ["quiet", "busy"]:
        with _precedence(), spinning(os.cpu_count() or 1) if beside == "busy" else contextlib.nullcontext():
            attacks = [] if arguments.only == "endings" else [arguments.only] if arguments.only else list(ATTACKERS)
            failed += list(_attacks(beside, attacks, arguments.trials))
            if arguments.only in {None, "endings"}:
                failed += list(_endings(beside, arguments.endings))
    for what in failed:
        print(f"NOT HELD: {what}")
    sys.exit(bool(failed))


def _attacks(beside: str, attacks: list[str], trials: int) -> Iterator[str]:
    if not attacks:
        return
    print(f"\n{beside:38}  stop on all wires [ms]         heart's loop [ms]   memory [MiB]   missions front")
    print(
        f"{'':38}{'trials':>8}{'p50':>8}{'p99.9':>8}{'max':>8}{'p99.9':>8}{'max':>8}{'heart':>8}{'front':>8}{'lost':>8}{'died':>6}"
    )
    for attack in attacks:
        with tempfile.TemporaryDirectory(prefix="robotd-heart-") as directory:
            suffered, lag_p999_ms, lag_max_ms = asyncio.run(_measured(Path(directory), attack, trials))
        ms = sorted(suffered.stops_ms)
        p50, p999 = percentile(ms, 0.5), percentile(ms, 0.999)
        print(
            f"{attack:38}{len(ms):8}{p50:8.1f}{p999:8.1f}{ms[-1]:8.1f}{lag_p999_ms:8.1f}{lag_max_ms:8.1f}"
            f"{suffered.heart_mib:8.0f}{suffered.front_mib:8.0f}{suffered.lost:8}{suffered.deaths:6}",
            flush=True,
        )
        yield from _broken(f"{attack}, {beside}", suffered, p999, lag_p999_ms, LAG_MS[beside])


def _broken(name: str, suffered: Suffered, p999_ms: float, lag_ms: float, may_lag_ms: float) -> Iterator[str]:
    bounds: list[tuple[str, float, float]] = [
        ("stop, p99.9 [ms]", p999_ms, STOP_MS),
        ("heart's loop lag, p99.9 [ms]", lag_ms, may_lag_ms),
        ("memory [MiB]", suffered.heart_mib + suffered.front_mib, MEMORY_MIB),
        ("missions that were lost", suffered.lost, 0),
        ("fronts that died", suffered.deaths, 0),
    ]
    yield from (f"{name}: {what} {value:.1f}, at most {bound:g}" for what, value, bound in bounds if value > bound)


async def _measured(directory: Path, attack: str, trials: int) -> tuple[Suffered, float, float]:
    samples_file = directory / "samples.npz"
    async with rig(directory) as it:
        with_a_large_map(it)
        async with it.daemon(("-m", "tests.studies.lag.measured", "plain", str(samples_file))) as process:
            suffered = await suffer(it, process.pid, [attack], trials)
            process.terminate()
            await process.wait()
    figures = Samples.read(samples_file).between(0, 2**62)
    return suffered, figures.lag_p999_ms, figures.lag_max_ms


def _endings(beside: str, trials: int) -> Iterator[str]:
    print(f"\n{beside:38}  stop after the lease [ms]      served again after [ms]")
    print(f"{'the front':38}{'trials':>8}{'p50':>8}{'p99.9':>8}{'max':>8}{'p50':>8}{'p99.9':>8}{'max':>8}")
    for number in (signal.SIGKILL, signal.SIGSTOP):
        for mode in MODES:
            with tempfile.TemporaryDirectory(prefix="robotd-heart-") as directory:
                ends = asyncio.run(_ended(Path(directory), mode, number, trials))
            stops = sorted(end.stop_late_ms for end in ends if end.stop_late_ms is not None)
            aways = sorted(end.away_ms for end in ends)
            columns = "".join(_columns(stops)) + "".join(_columns(aways))
            print(f"{f'{number.name} while {mode}':38}{trials:8}{columns}", flush=True)
            if stops and percentile(stops, 0.999) > STOP_MS:
                yield f"{number.name} while {mode}, {beside}: stop {percentile(stops, 0.999):.1f} ms after the lease"
            if percentile(aways, 0.999) > AWAY_MS:
                yield f"{number.name} while {mode}, {beside}: served again after {percentile(aways, 0.999):.0f} ms"
            if not all(end.is_as_before for end in ends):
                yield f"{number.name} while {mode}, {beside}: the heart noticed"


def _columns(ms: list[float]) -> Iterator[str]:
    of: list[Callable[[list[float]], float]] = [
        lambda ms: percentile(ms, 0.5),
        lambda ms: percentile(ms, 0.999),
        lambda ms: ms[-1],
    ]
    yield from (f"{one(ms):8.1f}" if ms else f"{'':8}" for one in of)


async def _ended(directory: Path, mode: str, number: signal.Signals, trials: int) -> list[Ended]:
    async with rig(directory) as it, it.daemon() as process:
        ends = []
        for _ in range(trials):
            ends.append(await end_front(it, process.pid, mode, number))
            await asyncio.sleep(_BETWEEN_S)
        return ends


if __name__ == "__main__":
    main()
