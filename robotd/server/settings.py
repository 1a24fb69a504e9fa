"""Where clients are served, and within which bounds."""

from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside
from robotd.core.endpoints import DEFAULT_RUNTIME_DIR

_MOST = 1_000_000
"""Longest queue, in messages."""


@dataclass(frozen=True, slots=True)
class ServerSettings:
    """Where and how clients are served."""

    runtime_dir: str = DEFAULT_RUNTIME_DIR
    """Directory of the sockets and of the lock that keeps a second daemon out."""
    lease_s: Annotated[float, Within(0.1, 10.0, "s")] = 0.5
    """How long a mission may go without ``renew`` from its client, unless the client asks for another lease [s]."""
    routine_hz: Annotated[float, Within(0.1, 1000.0, "Hz")] = 20.0
    """Odometry, predicted poses and sweep progress are published at most this often [Hz]."""
    max_request_bytes: Annotated[int, Within(1024, 2**24, "bytes")] = 65536
    """Largest request that is read; larger ones are refused."""
    max_pending_requests: Annotated[int, Within(1, _MOST)] = 32
    """Requests carried out at a time; more are refused as ``busy``. Stops are counted apart."""
    remembered_replies: Annotated[int, Within(1, _MOST)] = 256
    """Replies kept so that a repeated request is not carried out twice."""
    state_queue: Annotated[int, Within(1, _MOST)] = 256
    """Messages that wait for a slow reader before it misses some."""
    map_queue: Annotated[int, Within(1, _MOST)] = 8
    """Map messages that wait for a slow reader before it misses some."""

    def __post_init__(self) -> None:
        """Refuse what cannot work."""
        if not self.runtime_dir:
            raise ValueError("runtime_dir must not be empty")
        refuse_outside(self)
