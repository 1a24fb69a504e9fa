"""What ends the daemon: every signal that ends a program and lets it say a last word, which is the stop."""

import asyncio
import signal
from collections.abc import Callable

_ON_REQUEST = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""A person or the service manager wants it to end, and that is no failure."""
_OTHERS = (
    signal.SIGQUIT,
    signal.SIGABRT,
    signal.SIGUSR1,
    signal.SIGUSR2,
    signal.SIGALRM,
    signal.SIGVTALRM,
    signal.SIGPROF,
    signal.SIGXCPU,
    signal.SIGIO,
    signal.SIGPWR,
    signal.SIGTSTP,
)
"""By themselves they would end the program at once, or (Ctrl-Z) keep it from ever saying a word again. Signals of a
broken program (SIGSEGV and its like) are left alone: no Python runs after them."""
_SIGNALLED = 128
"""What shells add to the number of a signal that ended a program."""


class Ending:
    """Stops the robot when a signal comes, asks the program to end, and hastens it when another one comes."""

    def __init__(self, stop: Callable[[], None]) -> None:
        """Begin to hear signals, on the running loop, for the running task; what nohup ignores stays so.

        Args:
            stop: called at each signal; stops the robot, notes it and ends the mission, all at once: no step of the
                mission may follow a stop, in life as in a replay.
        """
        self.asked = asyncio.Event()
        self.reason = ""
        self.exit_code = 0
        self.is_hastened = False
        """Whether a second signal came: what is still waited for is given up."""
        self._stop = stop
        self._main = asyncio.current_task()
        for number in (*_ON_REQUEST, *_OTHERS):
            if number is not signal.SIGHUP or signal.getsignal(number) is not signal.SIG_IGN:
                asyncio.get_running_loop().add_signal_handler(number, self._told, number)

    def _told(self, number: signal.Signals) -> None:
        # Before it is even looked at which signal it is, and again for each that follows.
        try:
            self._stop()
        finally:  # whatever it meets, the end was asked for
            self._end(number)

    def _end(self, number: signal.Signals) -> None:
        if self.asked.is_set():
            self.is_hastened = True
            if self._main is not None:
                self._main.cancel()
            return
        self.reason = number.name
        # Who sent SIGQUIT or SIGABRT wants to see that it was not a regular end; the service manager then
        # starts it again.
        self.exit_code = 0 if number in _ON_REQUEST else _SIGNALLED + number
        self.asked.set()
