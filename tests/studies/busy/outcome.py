"""What became of one demonstration, read from what it said and from its daemon's log."""

import re
from dataclasses import dataclass

_LOCALIZED = re.compile(r"(\d+) of (\d+) (?:localized|kept-out stops localized)")
_STALL = re.compile(r"the event loop stood still for")
_HOLD = re.compile(r"held: (?:this machine was too busy|drive: no odometry)")
_SLOWED = "simulated time is slowed"
HEADER = """\
| beside | nice | frozen | finished | seconds | localized | stalls | holds | slowed | why it did not finish |
|---|---|---|---|---|---|---|---|---|---|"""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of one demonstration."""

    finished: bool
    took_s: float
    localized: str
    """How many of how many; empty if it did not come so far."""
    stalls: int
    """Of the daemon's loop, whether anything was driven or not."""
    holds: int
    slowed: bool
    """Whether simulated time was slowed."""
    reason: str
    """Its last words, if it did not finish."""

    @classmethod
    def of(cls, exit_code: int, took_s: float, said: str, log: str) -> "Outcome":
        """Read it; a demonstration that was found nowhere has not finished either."""
        counts = _LOCALIZED.findall(said)
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        finished = exit_code == 0 and bool(counts)
        return cls(
            finished=finished,
            took_s=took_s,
            localized="/".join(counts[-1]) if counts else "",
            stalls=len(_STALL.findall(log)),
            holds=len(_HOLD.findall(log)),
            slowed=_SLOWED in log,
            reason="" if finished else f"exit code {exit_code}: {lines[-1] if lines else 'it said nothing'}",
        )

    def row(self, busy: int, nice: int, frozen: str) -> str:
        """Return its line of the table."""
        yes = ("no", "yes")
        cells = (
            f"{busy} busy",
            str(nice),
            frozen,
            yes[self.finished],
            f"{self.took_s:.0f}",
            self.localized,
            str(self.stalls),
            str(self.holds),
            yes[self.slowed],
            self.reason.replace("|", "/"),
        )
        return f"| {' | '.join(cells)} |"
