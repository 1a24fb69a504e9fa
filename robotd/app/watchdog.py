"""Telling systemd how the daemon is: ``sd_notify``, and a watchdog that only a healthy loop feeds."""

import asyncio
import logging
import os
import socket
from collections.abc import Callable, Mapping

from robotd.core.clock import NS_PER_S, now_ns

_KIND = socket.SOCK_DGRAM | socket.SOCK_CLOEXEC | socket.SOCK_NONBLOCK
_LOOKS_PER_PERIOD = 20
_TOLERATED_LAG = 0.1
"""Largest lag of the loop that still counts as healthy, as a share of the watchdog's time."""


log = logging.getLogger(__name__)


class Notifier:
    """Sends state lines to the service manager; where there is none, it does nothing."""

    def __init__(self, address: str | None) -> None:
        """Take the address of ``NOTIFY_SOCKET``: a path, or ``@`` and a name of the abstract namespace."""
        self._address = f"\0{address[1:]}" if address and address.startswith("@") else address
        self._is_failing = False

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> "Notifier":
        """Return the notifier of this process, by ``NOTIFY_SOCKET``; one that says nothing where that is not set."""
        return cls(environment.get("NOTIFY_SOCKET"))

    def ready(self) -> None:
        """Say that clients can connect."""
        self.send("READY=1")

    def status(self, text: str) -> None:
        """Say in a line, for ``systemctl status``, what the daemon is at."""
        # One line: the next would be another assignment to the service manager.
        self.send(f"STATUS={text.splitlines()[0] if text else ''}")

    def stopping(self) -> None:
        """Say that the daemon is ending on purpose."""
        self.send("STOPPING=1")

    def feed(self) -> None:
        """Say that all is well, within the time that :func:`watchdog_s` returns."""
        self.send("WATCHDOG=1")

    def send(self, state: str) -> None:
        """Send a state; a manager that does not take it now is no reason to wait or to fail."""
        if not self._address:
            return
        try:
            # A socket for each: the service manager may be restarted, and then its old one leads nowhere.
            with socket.socket(socket.AF_UNIX, _KIND) as sender:
                sender.sendto(state.encode(), self._address)
        except OSError as error:  # no descriptor left, for one: the watchdog will tell, if it matters
            if not self._is_failing:
                log.warning("the service manager could not be told %s: %s", state.partition("=")[0], error)
            self._is_failing = True
        else:
            self._is_failing = False


def watchdog_s(environment: Mapping[str, str] = os.environ) -> float | None:
    """Return within which time systemd wants to be fed, or None if it does not."""
    try:
        wanted_us = int(environment.get("WATCHDOG_USEC", "0"))
        # The variables may have been meant for the process that started us.
        for_pid = int(environment.get("WATCHDOG_PID") or os.getpid())
    except ValueError:
        return None
    return wanted_us / 1e6 if wanted_us > 0 and for_pid == os.getpid() else None


async def feed_watchdog(notifier: Notifier, within_s: float, is_healthy: Callable[[], bool]) -> None:
    """Feed the watchdog twice in its time, but only while the loop turns quickly and ``is_healthy`` says so.

    After a bad look it looks again soon, so that a daemon that recovers in time lives, and one that does not is
    killed and restarted, which stops the robot.
    """
    period_s = within_s / 2
    while True:
        # Half of the time, so that one feeding may be missed by bad luck and the next still comes in time.
        worst_s = await _worst_lag_s(period_s)
        while worst_s > within_s * _TOLERATED_LAG or not is_healthy():
            worst_s = await _worst_lag_s(period_s / 4)
        notifier.feed()


async def _worst_lag_s(over_s: float) -> float:
    """Return by how much the loop was late at worst while it was asked to wake at regular times."""
    slice_s = over_s / _LOOKS_PER_PERIOD
    worst_s = 0.0
    for _ in range(_LOOKS_PER_PERIOD):
        before_ns = now_ns()
        await asyncio.sleep(slice_s)
        worst_s = max(worst_s, (now_ns() - before_ns) / NS_PER_S - slice_s)
    return worst_s
