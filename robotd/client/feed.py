"""A client's side of events, without sockets: decoded, each once, and every gap announced."""

from dataclasses import dataclass

from robotd.contract.topics import Frame, Published, Topic


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
    heard: set[str]
    """Events of this topic of which a message came."""


class Feed:
    """Puts the messages of a subscription in order."""

    def __init__(self) -> None:
        self._places: dict[str, _Place] = {}

    def accept(self, data: bytes) -> list[Published | Gap]:
        """Return what a frame brings: nothing if it was seen, else the event, after the gap before it if there is one.

        Raises:
            RemoteProtocolError: the frame is no message of ours.
        """
        items: list[Published | Gap] = []
        for item in self.sort(data):
            found = item if isinstance(item, Gap) else item.published
            items += [] if found is None else [found]
        return items

    def sort(self, data: bytes) -> list[Frame | Gap]:
        """Return the same with the frame as it is.

        Raises:
            RemoteProtocolError: it is no message of ours.
        """
        frame = Frame.of(data)
        # What was said before this reader came is no gap: the first message is the next one, whatever its number.
        place = self._places.setdefault(frame.topic, _Place(frame.session, frame.seq - 1, set()))
        # Another life of the daemon counts from 0 again: its numbers say nothing of what was missed.
        if place.session != frame.session:
            self._places[frame.topic] = _Place(frame.session, frame.seq, {frame.event})
            return [Gap(frame.topic, None), frame]
        if frame.seq <= place.seq:
            # Who joins is told the last of each event, the latest first; what was heard since is seen already.
            is_news = frame.event not in place.heard
            place.heard.add(frame.event)
            return [frame] if is_news else []
        missed = frame.seq - place.seq - 1
        place.seq = frame.seq
        place.heard.add(frame.event)
        return [Gap(frame.topic, missed), frame] if missed else [frame]


def as_topics(names: tuple[str, ...]) -> tuple[Topic, ...]:
    """Return the topics of these names, all of them if there is none.

    Raises:
        ValueError: there is no such topic.
    """
    return tuple(Topic(name) for name in names) or tuple(Topic)
