"""What Foxglove's app and a server of live data say to each other, as texts and bytes. Pure.

https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md, of which a server that only tells needs this much.
"""

import struct

import msgspec

from robotd.core.errors import ServerError

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
MOST_SUBSCRIPTIONS = 256
_MESSAGE = struct.Struct("<BIQ")
"""What it is, the subscription, and when it was told, Unix time [ns]."""
_MESSAGE_DATA = 1


class _Subscription(msgspec.Struct, frozen=True):
    id: int
    channelId: int  # noqa: N815  # as it is said


class Subscribe(msgspec.Struct, frozen=True, tag_field="op", tag="subscribe"):
    """An app wants channels, each under a number of its own."""

    subscriptions: tuple[_Subscription, ...]


class Unsubscribe(msgspec.Struct, frozen=True, tag_field="op", tag="unsubscribe", rename={"ids": "subscriptionIds"}):
    """An app wants some no longer."""

    ids: tuple[int, ...]


Said = Subscribe | Unsubscribe


class Subscriptions:
    """Which channels an app wants, and what it calls them."""

    def __init__(self) -> None:
        self._channels: dict[int, int] = {}

    def take(self, text: str) -> list[int]:
        """Take what an app says; return the channels that it wants from now on, of which it is told the latest.

        Raises:
            ServerError: it is nothing that a viewer may say.
        """
        try:
            said = msgspec.json.decode(text, type=Said)
        except (msgspec.DecodeError, RecursionError) as error:
            raise ServerError("malformed", f"this robot tells, and takes nothing else: {error}") from error
        if isinstance(said, Unsubscribe):
            for number in said.ids:
                self._channels.pop(number, None)
            return []
        for one in said.subscriptions:
            if len(self._channels) >= MOST_SUBSCRIPTIONS or not 0 <= one.id < 1 << 32:
                raise ServerError("too_many", f"up to {MOST_SUBSCRIPTIONS} subscriptions, of numbers of 32 bits")
            self._channels[one.id] = one.channelId
        return [one.channelId for one in said.subscriptions]

    def of(self, channel: int) -> list[int]:
        """Return under which numbers a channel is wanted."""
        return [number for number, wanted in self._channels.items() if wanted == channel]


def server_info(robot: str, session: str) -> str:
    """Say who tells; it takes nothing from an app, so it has no capabilities."""
    return _text(op="serverInfo", name=robot, capabilities=[], supportedEncodings=[], metadata={}, sessionId=session)


def advertise(channels: list[dict[str, object]]) -> str:
    """Say which channels there are, beside those that were said."""
    return _text(op="advertise", channels=channels)


def problem(message: str) -> str:
    """Say what is wrong."""
    return _text(op="status", level=2, message=message)


def message(subscription: int, unix_ns: int, data: bytes) -> bytes:
    """Return a message of a channel."""
    return _MESSAGE.pack(_MESSAGE_DATA, subscription, unix_ns) + data


def _text(**fields: object) -> str:
    return msgspec.json.encode(fields).decode()
