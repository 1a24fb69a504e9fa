"""What is measured, a row each: figures for the table, and which bounds they break."""

import asyncio
import random
import signal
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.studies.heart.endings import end_front
from tests.studies.heart.last_words import ended_ms, with_a_wide_map
from tests.studies.heart.trials import suffer, with_a_large_map
from tests.studies.lag.samples import Samples
from tests.studies.safety.run import percentile
from tests.support.real_rig import rig
from tests.support.repeated import repeated

STOP_MS = 50.0
LAG_MS = {"quiet": 5.0, "busy": 20.0}
MEMORY_MIB = 300.0
AWAY_MS = 1000.0
END_MS = 500.0
ATTACKED = "stop p50 | p99.9 | max [ms] | lag p99.9 | max [ms] | heart | front [MiB] | missions lost | front died"
LEFT = "stop after the lease p50 | p99.9 | max [ms] | served again p50 | p99.9 | max [ms]"
ENDED = "all ended p50 | p99.9 | max [ms]"
_BETWEEN_S = 1.1
"""A front that lived so long is followed at once by the next one."""


@dataclass(frozen=True, slots=True)
class Row:
    """Of a table."""

    what: str
    trials: int
    figures: tuple[str, ...]
    broken: tuple[str, ...]
    """What does not hold, with its figure and its bound."""

    def line(self, beside: str) -> str:
        """Return it as the table has it."""
        verdict = "; ".join(self.broken) or "yes"
        return "| " + " | ".join((self.what, beside, str(self.trials), *self.figures, verdict)) + " |"


def header(columns: str) -> str:
    """Return the head of a table with these columns."""
    names = f"| while | beside | trials | {columns} | held |"
    return f"{names}\n|{'---|' * (names.count('|') - 1)}"


async def attack_row(attack: str, trials: int, directory: Path, beside: str) -> Row:
    """Stops, while clients take too much."""
    samples_file = directory / "samples.npz"
    async with rig(directory) as it:
        with_a_large_map(it)
        async with it.daemon(("-m", "tests.studies.lag.measured", "plain", str(samples_file))) as process:
            suffered = await suffer(it, process.pid, [attack], trials)
            process.terminate()
            await process.wait()
    lag = (await asyncio.to_thread(Samples.read, samples_file)).between(0, 2**62)
    bounds = [
        ("stop p99.9 [ms]", p999_of(suffered.stops.found), STOP_MS),
        ("lag p99.9 [ms]", lag.lag_p999_ms, LAG_MS[beside]),
        ("memory [MiB]", suffered.heart_mib + suffered.front_mib, MEMORY_MIB),
        ("missions lost", suffered.lost, 0.0),
        ("fronts that died", suffered.deaths, 0.0),
    ]
    memory = (f"{mib:.0f}" for mib in (suffered.heart_mib, suffered.front_mib))
    figures = (
        *shown(suffered.stops.found),
        *(f"{lag.lag_p999_ms:.1f}", f"{lag.lag_max_ms:.1f}"),
        *(*memory, str(suffered.lost), str(suffered.deaths)),
    )
    return Row(attack, len(suffered.stops.found), figures, tuple(broken(suffered.stops.failures, bounds)))


async def ending_row(mode: str, number: signal.Signals, trials: int, directory: Path, _: str) -> Row:
    """The front ended, or stopped, again and again."""
    async with rig(directory) as it, it.daemon() as process:

        async def trial() -> tuple[float | None, float, bool]:
            ended = await end_front(it, process.pid, mode, number)
            await asyncio.sleep(_BETWEEN_S)
            return ended.stop_late_ms, ended.away_ms, ended.is_as_before

        ends = await repeated(trials, trial)
    stops = [late_ms for late_ms, _, _ in ends.found if late_ms is not None]
    aways = [away_ms for _, away_ms, _ in ends.found]
    bounds = [("stop p99.9 [ms]", p999_of(stops), STOP_MS), ("served again p99.9 [ms]", p999_of(aways), AWAY_MS)]
    bounds.append(("modes that changed", sum(not is_as_before for _, _, is_as_before in ends.found), 0.0))
    figures = (*shown(stops), *shown(aways))
    return Row(f"{number.name} of the front, {mode}", len(aways), figures, tuple(broken(ends.failures, bounds)))


async def end_row(trials: int, directory: Path, _: str) -> Row:
    """The daemon told to end, while its head computes."""
    rng = random.Random(1)
    async with rig(directory) as it:
        with_a_wide_map(it)
        ends = await repeated(trials, lambda: ended_ms(it, rng))
    bounds = [("ended p99.9 [ms]", p999_of(ends.found), END_MS)]
    return Row(
        "SIGTERM while the head computes", len(ends.found), shown(ends.found), tuple(broken(ends.failures, bounds))
    )


def broken(failures: Sequence[str], bounds: Sequence[tuple[str, float, float]]) -> Iterator[str]:
    """Yield what does not hold."""
    yield from failures
    yield from (f"{what} {value:.0f}, at most {bound:g}" for what, value, bound in bounds if value > bound)


def p999_of(values: list[float]) -> float:
    """Return the value that 99.9 % of them do not exceed; 0 of none."""
    return percentile(sorted(values), 0.999) if values else 0.0


def shown(values: list[float]) -> tuple[str, str, str]:
    """Return median, 99.9 % and maximum of values, as the table has them."""
    if not values:
        return "", "", ""
    return f"{percentile(sorted(values), 0.5):.1f}", f"{p999_of(values):.1f}", f"{max(values):.1f}"
