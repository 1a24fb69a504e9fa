"""Whether a child is ready, of our version, and lives: asked by numbers, which it gives back."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from robotd.children.channel import Channel
from robotd.children.processor import Share
from robotd.core.errors import ChildError
from robotd.core.silence import within
from robotd.core.text import printable_bytes

READY = b"ready "
"""What a child says first, before its version."""
_NUMBER = 8
"""Bytes of a ping."""
_LEAST_S = 0.01
"""Less is not waited for."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long to wait for a child; what it waits for a processor itself comes on top."""

    ready_s: float = 10.0
    """Until it is ready."""
    silent_s: float = 0.3
    """For the answer to a ping: what is stuck or stopped for so long is killed."""
    between_s: float = 0.1
    """From one ping to the next."""
    goodbye_s: float = 0.2
    """What a child has to end in by itself, once it was hung up on."""


async def watch(
    life: Channel,
    version: str,
    patience: Patience,
    is_ready: Callable[[], None],
    share: Callable[[], Share],
) -> NoReturn:
    """Watch over a child for as long as it is well.

    Args:
        life: the channel to it.
        version: what it has to be.
        patience: how long to wait for it. The time for which this process itself stood still does not count.
        is_ready: called once it is ready.
        share: tells what it has had of the processors.

    Raises:
        ChildError: it is not well; says how. It is then for the caller to kill it.
    """
    await _ready(life, version, patience.ready_s, share)
    is_ready()
    number = 0
    while True:
        number += 1
        # A number that was never sent before: an echo of the last ping does not pass for an answer to this one.
        life.send(number.to_bytes(_NUMBER, "little"))
        await _answered(life, number, patience.silent_s, share)
        # After the answer: one ping is under way at a time, so a slow child is not buried in them.
        await asyncio.sleep(patience.between_s)


async def _ready(life: Channel, version: str, within_s: float, share: Callable[[], Share]) -> None:
    try:
        said = await _said(life, within_s, share)
    except TimeoutError:
        raise ChildError(f"it was not ready within {within_s:g} s") from None
    if not said.startswith(READY):
        raise ChildError(f"it began with {_shown(said)}, expected that it is ready")
    if said != READY + version.encode():
        raise ChildError(f"it is version {_shown(said[len(READY) :])}, this is {version}")


async def _answered(life: Channel, number: int, within_s: float, share: Callable[[], Share]) -> None:
    try:
        said = await _said(life, within_s, share)
    except TimeoutError:
        raise ChildError(f"it was silent for {within_s:g} s") from None
    # One ping is under way at a time: any other number is an answer twice given, or to what was never asked.
    if said != number.to_bytes(_NUMBER, "little"):
        raise ChildError(f"it answered ping {number} with {_shown(said)}")


async def _said(life: Channel, within_s: float, share: Callable[[], Share]) -> bytes:
    """Return what it says next; TimeoutError if it does not within the time that it was free to."""
    before, waited_s, left_s = share(), 0.0, within_s
    while left_s > _LEAST_S:
        try:
            async with within(left_s, of=""):
                return bytes(await life.receive())
        except TimeoutError:
            waited_s += left_s
            # Only what the child could have used counts: on a busy machine it may wait for a processor longer
            # than it may be silent.
            left_s = within_s - share().could_act_s(before, waited_s)
    raise TimeoutError


def _shown(said: bytes) -> str:
    return repr(printable_bytes(said[:40]))
