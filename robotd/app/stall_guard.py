"""A thread that stops a base that is driven when the event loop does not turn, and the one who notices all stalls.

All else that stops the robot runs on the loop: a loop that is stuck, in a computation that somebody forgot to hand to
a thread or in a system call that does not return, can neither let a lease expire nor hear a client. The boards' deadman
ends a motion in its time even then; this is sooner, and it is all that a base without a watchdog of its own has.
"""

import asyncio
import contextlib
import logging
import sys
import threading
import traceback
from collections.abc import AsyncIterator, Callable
from itertools import count
from typing import NoReturn

from robotd.app.callbacks import fail
from robotd.core.attention import attention
from robotd.hardware.devices.device import PAST_LOOP_S

STALL_S = 0.2
"""So long without a turn of the loop is a stall: half of what a set-point lives by default, so as to be before
the deadman."""
LATE_S = 0.1
"""So late a beat is noted, so that no partner is taken for silent whom we did not hear."""
_BEAT_EVERY_S = STALL_S / 4
_SWITCH_S = 0.0005
"""A loop that computes holds the interpreter's lock; the guard asks for it a dozen times on its way to three wires, and
each time the loop may keep it for so long. Python's own 5 ms would add up to more than the stop may take."""

log = logging.getLogger(__name__)

Stalled = Callable[[float, bool, str], None]


@contextlib.asynccontextmanager
async def guarded(
    must_stop: Callable[[], bool], stop_past_loop: Callable[[int], None], stalled: Stalled
) -> AsyncIterator[None]:
    """Guard the running loop for as long as the block lasts.

    Args:
        must_stop: says whether there is anything to stop; asked in the guard's thread.
        stop_past_loop: puts the stop on every wire; called in the guard's thread, again every :data:`PAST_LOOP_S` until
            the loop turns, and told how often it was called before in this stall.
        stalled: called on the loop, as soon as it turns again: how long it stood still, whether the robot was stopped,
            and where the loop was.
    """
    guard = _Guard(must_stop, stop_past_loop, stalled)
    # A daemon thread: an interpreter that ends must not wait for one that waits for the loop.
    thread = threading.Thread(target=guard.watch, name="stall guard", daemon=True)
    switch_s = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_S)
    thread.start()
    attention().watch(guard.look)
    beating = asyncio.create_task(guard.beat(), name="stall guard")
    try:
        yield
    finally:
        attention().watch(None)
        beating.cancel()
        await asyncio.wait({beating})
        guard.end()
        thread.join()
        sys.setswitchinterval(switch_s)


class _Guard:
    def __init__(self, must_stop: Callable[[], bool], stop_past_loop: Callable[[int], None], stalled: Stalled) -> None:
        self._must_stop = must_stop
        self._stop_past_loop = stop_past_loop
        self._stalled = stalled
        self._due_s: float | None = None
        """When the next beat is due; None before the first."""
        self._has_stopped = threading.Event()
        self._loop_thread = threading.get_ident()
        self._stuck_in = ""
        self._beaten = threading.Event()
        self._is_ending = False

    async def beat(self) -> NoReturn:
        """Show that the loop turns."""
        while True:
            self._beaten.set()
            self.look()
            self._due_s = asyncio.get_running_loop().time() + _BEAT_EVERY_S
            await asyncio.sleep(_BEAT_EVERY_S)

    def look(self) -> None:
        """Tell of a stall that has just ended, once; asked by the beat, and by readers of what came meanwhile."""
        if self._due_s is None:
            return
        now_s = asyncio.get_running_loop().time()
        late_s = now_s - self._due_s
        has_stopped = self._has_stopped.is_set()
        if late_s < LATE_S and not has_stopped:
            return
        if has_stopped:
            late_s = max(late_s, STALL_S)  # so long the thread waited, whatever of it was told before it got its turn
        self._has_stopped.clear()
        self._due_s = now_s + _BEAT_EVERY_S
        where, self._stuck_in = self._stuck_in or "an unknown place: it was too short to look", ""
        try:
            self._stalled(late_s, has_stopped, where)
        except Exception as error:  # a mistake of ours must not end the beat, nor the reader who asked
            fail(error, "a stall could not be told")

    def watch(self) -> None:
        """Wait for one beat after the other; stop the robot when one is late."""
        while not self._is_ending:
            # A wait with a bound, not a sleep: the thread is woken by each beat, and computes nothing in
            # between.
            if not self._beaten.wait(STALL_S):
                if self._has_reason():
                    # Before its first byte: the loop may turn again while this thread waits for its turn, and a board
                    # that says that it was stopped must find a stall told that explains it.
                    self._has_stopped.set()
                    self._stop(0)
                    # After the stop: to walk the stack takes time that a stop has not.
                    self._stuck_in = self._where()
                    self._go_on_stopping()
                else:
                    self._stuck_in = self._where()
                    self._beaten.wait()
            self._beaten.clear()

    def _go_on_stopping(self) -> None:
        """Say the stop until the loop turns, which then sees whether it was obeyed: from here nobody can."""
        for before in count(1):
            if self._beaten.wait(PAST_LOOP_S):
                return
            self._stop(before)

    def _has_reason(self) -> bool:
        try:
            return self._must_stop()
        except Exception:
            log.exception("whether the robot must be stopped past the loop cannot be said")
            return True

    def _stop(self, before: int) -> None:
        """Stop; what goes wrong must not end the thread: the loop stops, too, as soon as it turns."""
        try:
            self._stop_past_loop(before)
        except Exception:
            log.exception("the robot could not be stopped past the loop")

    def _where(self) -> str:
        """Return where the loop's thread is: who reads the log wants to know what held it up."""
        frame = sys._current_frames().get(self._loop_thread)  # noqa: SLF001  # the documented way, for all its underscore
        return "".join(traceback.format_stack(frame)).rstrip() if frame is not None else "nowhere: its thread ended"

    def end(self) -> None:
        """Let the thread end."""
        self._is_ending = True
        self._beaten.set()
