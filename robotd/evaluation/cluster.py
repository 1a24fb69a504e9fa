"""A schedule over a cluster of Dask's: processes of this machine, or the workers of a scheduler somewhere else.

Needs the extra ``scale``. A worker that dies is replaced, or its cases go to others, by Dask. Anyone who reaches a
scheduler runs programs on its machines, so there is no way to one but by TLS with certificates on both sides; a cluster
of this machine has certificates of its own, made for the run.
"""

import importlib
import logging
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Any

from robotd.core.errors import RobotdError
from robotd.evaluation.schedule import AHEAD, Answer, Case, Schedule

Client = Any
"""Of Dask, which has no types, and is imported where it is needed: only here is the extra."""

_LOCAL, _REMOTE = "local:", "tls://"
_PATIENCE_S = 60
"""How long a scheduler is waited for, and its first worker."""


def checked_address(text: str) -> str:
    """Return where a cluster is.

    Raises:
        ValueError: it is neither ``local:N`` nor ``tls://HOST``; of plain TCP says why not.
    """
    count = text.removeprefix(_LOCAL)
    if (text != count and count.isdecimal() and int(count) >= 1) or text.partition(_REMOTE)[2]:
        return text
    why = (
        "anyone who reaches a scheduler by plain TCP runs programs on its machines; " if text.startswith("tcp:") else ""
    )
    raise ValueError(f"{why}expected {_LOCAL}N or {_REMOTE}HOST, got {text!r}")


def require_dask() -> None:
    """Load what spreads.

    Raises:
        RobotdError: it is not installed; says how to.
    """
    try:
        for module in ("distributed", "cryptography"):
            importlib.import_module(module)
    except ImportError as error:
        raise RobotdError(
            f"--scheduler needs Dask ({error}): install the extra scale,"
            " pip install 'robotd[scale]', or pip install -e '.[scale]' in a clone"
        ) from error


def over_cluster(address: str) -> Schedule:
    """Return a schedule over the workers at an address of :func:`checked_address`.

    Raises RobotdError where the scheduler cannot be reached, has no workers, or a case kills every worker it meets.
    """

    def spread(job: Callable[[Case], Answer], cases: Iterable[Case], /) -> Iterator[Answer]:
        with _client_at(address) as client:
            yield from spread_over(client, job, cases)

    return spread


def spread_over(client: Client, job: Callable[[Case], Answer], cases: Iterable[Case]) -> Iterator[Answer]:
    """Answer cases by the workers that a client has, in order."""
    dask: Any = importlib.import_module("distributed")
    window: deque[Any] = deque()
    source = iter(cases)
    try:
        while True:
            # Asked each time: a cluster grows and shrinks.
            most = AHEAD * max(1, sum(client.nthreads().values()))
            # Not pure: that would have Dask hash each case to find out whether it was asked before.
            window.extend(client.submit(job, case, pure=False) for case in islice(source, most - len(window)))
            if not window:
                return
            answer: Answer = window[0].result()
            window.popleft()
            yield answer
    except dask.KilledWorker as error:
        raise RobotdError(f"workers died again and again over the same cases: {error}") from error
    finally:
        client.cancel(list(window))


@contextmanager
def _client_at(address: str) -> Iterator[Client]:
    dask: Any = importlib.import_module("distributed")
    if address.startswith(_LOCAL):
        # One thread each: a case's processor time is that of its process.
        with (
            dask.LocalCluster(
                n_workers=int(address.removeprefix(_LOCAL)),
                threads_per_worker=1,
                dashboard_address=None,
                memory_limit=0,
                security=dask.Security.temporary(),
                silence_logs=logging.CRITICAL,
            ) as cluster,
            dask.Client(cluster) as client,
        ):
            yield client
        return
    security = dask.Security(require_encryption=True)
    if None in (security.tls_ca_file, security.tls_client_cert, security.tls_client_key):
        raise RobotdError(f"{address}: no certificates; name them in the configuration of Dask, distributed.comm.tls")
    with ExitStack() as stack:
        try:
            client = stack.enter_context(dask.Client(address, security=security, timeout=_PATIENCE_S))
            client.wait_for_workers(1, timeout=_PATIENCE_S)
        except OSError as error:  # a time-out is one
            raise RobotdError(f"{address}: no scheduler with a worker was reached: {error}") from error
        yield client
