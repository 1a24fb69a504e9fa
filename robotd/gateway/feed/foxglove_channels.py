"""The robot as Foxglove's app reads it live: frames of the daemon in, the latest message of each channel out. Pure."""

from dataclasses import dataclass

import msgspec

from robotd.contract.topics import Frame
from robotd.interop.foxglove_messages import SCHEMAS, FoxgloveFrames


@dataclass(frozen=True, slots=True)
class FoxgloveChannel:
    """Messages of one kind under one name."""

    id: int
    topic: str
    schema: str


class FoxgloveChannels:
    """What there is to show, and the latest of each: an app that joins, or is slow, is told that and no more."""

    def __init__(self, wall_offset_ns: int) -> None:
        """Take from monotonic to Unix time [ns]."""
        self._frames = FoxgloveFrames(wall_offset_ns)
        self.channels: dict[str, FoxgloveChannel] = {}
        """By topic; more come with the first message of their kind."""
        self.latest: dict[int, bytes] = {}
        """By channel: a message, as JSON."""

    def take(self, frame: Frame) -> list[FoxgloveChannel]:
        """Take a frame; return the channels of which there is something newer now.

        Raises:
            RemoteProtocolError: it is not what its name promises.
        """
        event = frame.published
        if event is None:
            return []
        told = []
        for message in self._frames.messages(event):
            channel = self.channels.setdefault(
                message.topic, FoxgloveChannel(len(self.channels) + 1, message.topic, message.schema)
            )
            self.latest[channel.id] = msgspec.json.encode(message.content)
            told.append(channel)
        return told


def advertised(channels: list[FoxgloveChannel]) -> list[dict[str, object]]:
    """Return channels as an app is told of them."""
    return [
        {
            "id": channel.id,
            "topic": channel.topic,
            "encoding": "json",
            "schemaName": channel.schema,
            "schema": msgspec.json.encode(SCHEMAS[channel.schema]).decode(),
            "schemaEncoding": "jsonschema",
        }
        for channel in channels
    ]
