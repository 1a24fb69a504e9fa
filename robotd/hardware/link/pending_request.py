"""A request that waits for its reply, and what a reply says."""

import asyncio

from firmware_proto.common import Ack, ConfigureReply, Nack, Result
from firmware_proto.schema import REPLY, Message
from robotd.core.errors import DeviceError, RobotdError
from robotd.core.silence import within
from robotd.hardware.wire.board import Received


class PendingRequest:
    """One request under way; made and settled on the event loop."""

    def __init__(self, device: str, message: Message, seq: int) -> None:
        self.message = message
        self.seq = seq
        self._device = device
        self._reply: asyncio.Future[Received] = asyncio.get_running_loop().create_future()

    async def wait(self, timeout_s: float) -> Received | None:
        """Return the reply, or None if there is none yet after ``timeout_s``; raise what it failed with."""
        try:
            async with within(timeout_s, of=f"{self._device} answer"):
                return await asyncio.shield(self._reply)  # the next try waits for the same reply
        except TimeoutError:
            return None

    def is_answered_by(self, received: Received) -> bool:
        """Say whether this is the first reply to it."""
        # A request that was repeated may be answered as often as it was said; the first answer settles it.
        return not self._reply.done() and (self.message.TYPE, self.seq) == (answered_type(received), received.seq)

    def settle(self, received: Received) -> None:
        """End it with its reply: a refusal raises DeviceError where it is waited for."""
        result = result_of(received.message)
        if result == Result.OK:  # any other is a refusal, those of later versions included
            self._reply.set_result(received)
        else:
            self.fail(DeviceError(self._device, _name(result), type(self.message).__name__))

    def fail(self, error: RobotdError) -> None:
        """End it with an error, unless it has ended."""
        if not self._reply.done():
            self._reply.set_exception(error)


def answered_type(received: Received) -> int:
    """Return the type of the request that a reply or NACK is about."""
    return received.message.of_type if isinstance(received.message, Nack) else received.type - REPLY


def result_of(reply: Message) -> int:
    """Return the result in a reply; a reply that has none says OK by being one."""
    if isinstance(reply, Nack):
        return reply.code
    return reply.result if isinstance(reply, Ack | ConfigureReply) else Result.OK


def _name(result: int) -> str:
    try:
        return Result(result).name.lower()
    except ValueError:
        return f"result_{result}"  # of a later version: shown as its number
