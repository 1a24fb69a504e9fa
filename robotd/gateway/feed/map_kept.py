"""The map in use as frames: the last whole one, and the changes since. Packed once, for however many look at it."""

from typing import Any

import numpy as np

from robotd.contract.events import MapChanged
from robotd.contract.plain import from_plain, to_plain
from robotd.contract.topics import Topic, encode_frame
from robotd.gateway.feed.heard_frames import HeardFrame

MOST_CHANGES = 64
MOST_BYTES = 1 << 20
"""Changes kept; beyond either bound they are laid into the whole map."""


class MapKept:
    """What a browser that joins is told of the map."""

    def __init__(self) -> None:
        self._whole: HeardFrame | None = None
        self._changes: list[HeardFrame] = []

    @property
    def frames(self) -> list[bytes]:
        """The whole map and its changes, in order; nothing if none is known."""
        return [] if self._whole is None else [one.data for one in (self._whole, *self._changes)]

    @property
    def is_long(self) -> bool:
        """Whether the changes should be laid into the whole map."""
        return len(self._changes) > MOST_CHANGES or sum(len(one.data) for one in self._changes) > MOST_BYTES

    def accept(self, heard: HeardFrame) -> bool:
        """Take a change; return False if it does not follow on what is known: the whole has to be asked for."""
        if heard.fields["whole"]:
            self._whole, self._changes = heard, []
            return True
        if self._whole is None or _key(heard) != _key(self._whole):
            return False
        generation = (self._changes or [self._whole])[-1].fields["generation"]
        if heard.fields["generation"] <= generation:
            return True  # an old one, or the one that the whole map came with
        if heard.fields["generation"] != generation + 1:
            return False
        self._changes.append(heard)
        return True

    def forget(self) -> None:
        """Know no map."""
        self._whole, self._changes = None, []

    def parts(self) -> tuple[HeardFrame, list[HeardFrame]] | None:
        """Return what :func:`folded` makes one of: it takes long, so another thread does it."""
        return None if self._whole is None else (self._whole, list(self._changes))

    def replace(self, whole: HeardFrame) -> None:
        """Take the whole map that was made of some of the changes; those after it stay."""
        if self._whole is not None and _key(whole) == _key(self._whole):
            generation = whole.fields["generation"]
            self._changes = [one for one in self._changes if one.fields["generation"] > generation]
            self._whole = whole


def folded(whole: HeardFrame, changes: list[HeardFrame]) -> HeardFrame:
    """Return a whole map with changes laid into it.

    Raises:
        RemoteProtocolError: one of them contradicts itself.
    """
    last = (changes or [whole])[-1]
    begun = from_plain(MapChanged, whole.fields)
    # A copy: what was decoded may be shared, or read-only.
    grid = np.array(begun.values)
    for heard in changes:
        change = from_plain(MapChanged, heard.fields)
        grid.reshape(-1)[change.cells] = change.values
    made = MapChanged(
        last.fields["time_ns"],
        begun.map_id,
        last.fields["generation"],
        begun.spec,
        whole=True,
        cells=np.empty(0, dtype=np.intp),
        values=grid,
        stops=last.fields.get("stops"),
    )
    return as_heard(made, last.session, last.seq)


def as_heard(change: MapChanged, session: str, seq: int) -> HeardFrame:
    """Return a whole map as the daemon would have told it."""
    fields: dict[str, Any] = {"event": "map_changed", **to_plain(change)}
    data = encode_frame(Topic.MAP, session, seq, fields)
    return HeardFrame(Topic.MAP, session, seq, "map_changed", data, fields)


def _key(heard: HeardFrame) -> tuple[object, ...]:
    return tuple(heard.fields[name] for name in ("map_id", "rows", "cols", "origin_x_m", "origin_y_m"))
