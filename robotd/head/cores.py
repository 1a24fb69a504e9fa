"""How much of the machine may be used."""

import os


def cores() -> int:
    """Return how many processor cores this process may use."""
    # Not os.cpu_count(): a service may be confined to some of them.
    return len(os.sched_getaffinity(0))
