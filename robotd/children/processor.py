"""What a process has had of the processors: one that was not given any is late, and that is no fault of its own."""

from dataclasses import dataclass
from pathlib import Path

from robotd.core.clock import NS_PER_S


@dataclass(frozen=True, slots=True)
class Share:
    """Of its first thread, since it was started."""

    ran_s: float = 0.0
    waited_s: float = 0.0
    """For its turns; one that it waits for still is not in it."""
    wants_it: bool = False
    """Whether it runs, or waits for its turn, now."""

    def could_act_s(self, before: "Share", since_s: float) -> float:
        """Return for how long of the ``since_s`` that passed since ``before`` it was free to act."""
        return self.ran_s - before.ran_s if self.wants_it else since_s - (self.waited_s - before.waited_s)


def share_of(pid: int) -> Share:
    """Return the share of a process; of one that ended, or where the kernel does not count, that of one never late."""
    try:
        ran_ns, waited_ns, _ = Path(f"/proc/{pid}/schedstat").read_text(encoding="ascii").split()
        # After the name, which may hold anything.
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()[0]
    # Ended since, or no `schedstat` in this kernel: then patience goes by the clock alone.
    except (OSError, ValueError):
        return Share()
    return Share(int(ran_ns) / NS_PER_S, int(waited_ns) / NS_PER_S, state == "R")
