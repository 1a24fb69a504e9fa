"""The ROUTER socket: what comes, from whom, and the answers; no message that goes wrong ends the daemon."""

import asyncio
import logging
from dataclasses import dataclass

import zmq
import zmq.asyncio

from robotd.core.log_limit import LogLimit

_AFTER_ERROR_S = 0.1
"""A socket that fails again and again must not keep the loop busy."""
_SHOWN = 10
"""Digits of an identity that tell clients apart in a log."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Letter:
    """What one client sent."""

    route: list[bytes]
    """What goes before the answer: the client's identity, and the empty frame if it put one before its request."""
    frames: list[bytes]
    """The request itself; one frame, as it should be."""
    sender: str
    """Who it was, for the log."""

    @property
    def identity(self) -> bytes:
        """What tells this client from the others."""
        return self.route[0]


class Router:
    """Receives and answers until cancelled."""

    def __init__(self, socket: zmq.asyncio.Socket) -> None:
        self._socket = socket
        self._complaints = LogLimit()

    async def receive(self) -> Letter:
        """Wait for the next request."""
        while True:
            try:
                # Frames, not bytes: they alone know which process they came from.
                frames = await self._socket.recv_multipart(copy=False)
            except zmq.ZMQError as error:
                await self._complain("a request could not be received", error)
                continue
            return _letter(frames)

    async def answer(self, route: list[bytes], reply: bytes) -> None:
        """Answer; what cannot be sent is lost, as to a client that has gone, which will ask again."""
        try:
            await self._socket.send_multipart([*route, reply])
        except zmq.ZMQError as error:
            await self._complain("an answer could not be sent", error)

    async def _complain(self, what: str, error: zmq.ZMQError) -> None:
        if self._socket.closed:
            raise error
        if line := self._complaints.line(f"{what}: {error.strerror}"):
            log.warning("%s", line)
        await asyncio.sleep(_AFTER_ERROR_S)


def _letter(frames: list[zmq.Frame]) -> Letter:
    identity, *rest = (frame.bytes for frame in frames)
    is_enveloped = len(rest) > 1 and rest[0] == b""
    route, request = ([identity, b""], rest[1:]) if is_enveloped else ([identity], rest)
    return Letter(route, request, f"client {identity.hex()[:_SHOWN]}{_process(frames[-1])}")


def _process(frame: zmq.Frame) -> str:
    """Return which process sent a frame, as the kernel knows it: libzmq gives ``host:uid:gid:pid``."""
    try:
        _, uid, _, pid = str(frame.get("Peer-Address")).rsplit(":", 3)
    except (zmq.ZMQError, ValueError, AttributeError):
        return ""
    return f" (uid {uid}, pid {pid})"
