"""A thread that stops the robot when the event loop does not turn.

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

from robotd.hardware.devices.device import PAST_LOOP_S

STALL_S = 0.2
"""So long without a turn of the loop is a stall."""
_BEAT_EVERY_S = STALL_S / 4
_SWITCH_S = 0.0005
"""A loop that computes holds the interpreter's lock; the guard asks for it a dozen times on its way to three wires, and
each time the loop may keep it for so long. Python's own 5 ms would add up to more than the stop may take."""

log = logging.getLogger(__name__)


@contextlib.asynccontextmanager
async def guarded(stop_past_loop: Callable[[int], None], stalled: Callable[[], None]) -> AsyncIterator[None]:
    """Guard the running loop for as long as the block lasts.

    Args:
        stop_past_loop: puts the stop on every wire; called in the guard's thread, every :data:`PAST_LOOP_S` until the
            loop turns again, and told how often it was called before in this stall.
        stalled: called on the loop, as soon as it turns again, so that everybody learns of the stop.
    """
    guard = _Guard(stop_past_loop)
    thread = threading.Thread(target=guard.watch, name="stall guard", daemon=True)
    switch_s = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_S)
    thread.start()
    beating = asyncio.create_task(guard.beat(stalled), name="stall guard")
    try:
        yield
    finally:
        beating.cancel()
        await asyncio.wait({beating})
        guard.end()
        thread.join()
        sys.setswitchinterval(switch_s)


class _Guard:
    def __init__(self, stop_past_loop: Callable[[int], None]) -> None:
        self._stop_past_loop = stop_past_loop
        self._loop_thread = threading.get_ident()
        self._stuck_in = ""
        self._beaten = threading.Event()
        self._fired = threading.Event()
        self._is_ending = False

    async def beat(self, stalled: Callable[[], None]) -> NoReturn:
        """Show that the loop turns."""
        while True:
            self._beaten.set()
            if self._fired.is_set():
                self._fired.clear()
                log.error(
                    "the event loop stood still for more than %g s: the robot was stopped; it was in\n%s",
                    STALL_S,
                    self._stuck_in,
                )
                stalled()
            await asyncio.sleep(_BEAT_EVERY_S)

    def watch(self) -> None:
        """Wait for one beat after the other; stop the robot when one is late."""
        while not self._is_ending:
            if not self._beaten.wait(STALL_S):
                self._stop(0)
                self._stuck_in = self._where()
                self._fired.set()
                self._go_on_stopping()
            self._beaten.clear()

    def _go_on_stopping(self) -> None:
        """Say the stop until the loop turns, which then sees whether it was obeyed: from here nobody can."""
        for before in count(1):
            if self._beaten.wait(PAST_LOOP_S):
                return
            self._stop(before)

    def _stop(self, before: int) -> None:
        """Stop; what goes wrong with it must not end the thread, which is all that is left."""
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
