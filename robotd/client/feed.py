"""A client's side of events, without sockets: decoded, each once, and every gap announced."""

from dataclasses import dataclass

from robotd.contract.topics import Published, Topic, decode_frame


@dataclass(frozen=True, slots=True)
class Gap:
    """Messages of a topic were missed: this reader was too slow, or the daemon restarted."""

    topic: str
    missed: int | None
    """How many; None if the daemon restarted, when it is not known."""


@dataclass(slots=True)
class _Place:
    session: str
    seq: int


class Feed:
    """Puts the messages of a subscription in order."""

    def __init__(self) -> None:
        self._places: dict[str, _Place] = {}

    def accept(self, frame: bytes) -> list[Published | Gap]:
        """Return what a frame brings: nothing if it was seen, else the event, after the gap before it if there is one.

        Raises:
            RemoteProtocolError: the frame is no message of ours.
        """
        message = decode_frame(frame)
        # What was said before this reader came is no gap: the first message is the next one, whatever its number.
        place = self._places.setdefault(message.topic, _Place(message.session, message.seq - 1))
        items: list[Published | Gap] = []
        if place.session != message.session:
            items.append(Gap(message.topic, None))
        elif message.seq <= place.seq:
            return []  # a greeting for somebody who joined later, which reaches all
        elif message.seq > place.seq + 1:
            items.append(Gap(message.topic, message.seq - place.seq - 1))
        self._places[message.topic] = _Place(message.session, message.seq)
        return items if message.event is None else [*items, message.event]


def as_topics(names: tuple[str, ...]) -> tuple[Topic, ...]:
    """Return the topics of these names, all of them if there is none.

    Raises:
        ValueError: there is no such topic.
    """
    return tuple(Topic(name) for name in names) or tuple(Topic)
