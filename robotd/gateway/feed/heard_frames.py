"""Frames of the daemon, read no further than a gateway must."""

from dataclasses import dataclass
from typing import Any, Self

import msgpack

from robotd.contract.topics import Frame
from robotd.core.errors import RemoteProtocolError

_READ = {"status", "mission_progress", "map_changed", "pose_estimate"}
"""What the gateway goes by itself; all else it hands on."""


@dataclass(frozen=True, slots=True)
class HeardFrame(Frame):
    """A message as it came, and what it says where the gateway needs that."""

    fields: dict[str, Any]
    """Empty for most events."""

    @classmethod
    def read(cls, frame: Frame) -> Self:
        """Return what a frame says.

        Raises:
            RemoteProtocolError: it cannot be read.
        """
        fields = fields_of(frame.data) if frame.event in _READ else {}
        return cls(frame.topic, frame.session, frame.seq, frame.event, frame.data, fields)


def fields_of(data: bytes) -> dict[str, Any]:
    """Return all that a message says, its envelope included.

    Raises:
        RemoteProtocolError: it cannot be read.
    """
    try:
        fields: dict[str, Any] = msgpack.unpackb(data.partition(b"\0")[2])
    except ValueError as error:
        raise RemoteProtocolError(f"not a message: {error!r}") from error
    return fields
