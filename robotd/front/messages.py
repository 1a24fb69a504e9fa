"""What goes between heart and front, as bytes, both ways; pure.

To the heart: requests, numbered upwards, in the envelope that clients use, and what clients read. From it: first the
settings, then answers in that envelope, events and lines of the log as they are published, and maps, whose cells are
not packed here: that takes long, and is the front's to do. One byte before each message says which of these it is.
"""

from typing import Any

import msgpack
import msgspec
import numpy as np

from robotd.children.channel import Message
from robotd.contract.answers import Done
from robotd.contract.envelope import Reply, decode_reply, encode_error, encode_result
from robotd.contract.events import MapChanged
from robotd.contract.request import Request
from robotd.contract.requests import REQUESTS
from robotd.contract.topics import Published, Topic, from_wire, to_wire
from robotd.core.errors import ChildError, RobotdError, ServerError
from robotd.core.grid_spec import GridSpec
from robotd.server.settings import ServerSettings

_ANSWER, _EVENT, _MAP = b"a", b"e", b"m"
_LENGTH = 4
_NO_NUMBER = -1
_INDEX = np.dtype("<u4")
"""Wide enough: the largest map has 2^26 cells."""

Parts = tuple[bytes | memoryview, ...]


class Watch(Request[Done], frozen=True):
    """Say which topics somebody reads; it is not answered, and no client can ask it."""

    cmd, result = "watch", Done
    topics: tuple[Topic, ...]


FROM_FRONT: dict[str, type[Request[Any]]] = {**REQUESTS, Watch.cmd: Watch}
"""What a front asks: what clients do, and this."""


class _MapHead(msgspec.Struct, frozen=True, array_like=True):
    """A map but for its cells."""

    number: int
    """Of the request that it answers; :data:`_NO_NUMBER` if it is an event."""
    time_ns: int
    map_id: str | None
    generation: int
    resolution_m: float
    origin_x_m: float
    origin_y_m: float
    rows: int
    cols: int
    whole: bool
    stops: int | None
    changed: int
    is_packed: bool = False
    """Whether its values are the whole grid as :mod:`robotd.core.grid_bytes` packs it."""


def settings_message(settings: ServerSettings) -> bytes:
    """Return the settings that a front works by."""
    return msgspec.msgpack.encode(settings)


def settings_of(message: Message) -> ServerSettings:
    """Return the settings of the heart's first message; ChildError if it holds none."""
    try:
        return msgspec.msgpack.decode(message, type=ServerSettings)
    except msgspec.MsgspecError as error:
        raise ChildError(f"the heart began with what are no settings: {error}") from error


def answer(number: int, result: object) -> Parts:
    """Return the answer to a request that was carried out."""
    if isinstance(result, MapChanged):
        return _map(number, result)
    return _ANSWER, encode_result(number, result)


def refusal(number: int, error: ServerError) -> Parts:
    """Return the answer to a request that was not."""
    return _ANSWER, encode_error(number, error)


def event(published: Published) -> Parts:
    """Return an event; TypeError, ValueError and their like if it has no form."""
    if isinstance(published, MapChanged):
        return _map(_NO_NUMBER, published)
    # In the form in which clients read it, so that there is no second one to keep in step.
    packed: bytes = msgpack.packb(to_wire(published)[1])
    return _EVENT, packed


def said(message: Message) -> Reply | tuple[int, MapChanged] | Published:
    """Return what the heart said: the answer to a request, a map that is one, or what happened.

    Raises:
        ChildError: it is none of these.
    """
    try:
        found = _said(message)
    except (ValueError, KeyError, TypeError, RobotdError) as error:
        raise ChildError(f"the heart said what nobody understands: {error!r}") from error
    if found is None:
        raise ChildError(f"the heart told of something that is not known: {bytes(message[:40])!r}")
    return found


def _said(message: Message) -> Reply | tuple[int, MapChanged] | Published | None:
    kind, rest = message[:1], memoryview(message)[1:]
    if kind == _ANSWER:
        return decode_reply(bytes(rest))
    if kind == _EVENT:
        fields: dict[str, Any] = msgpack.unpackb(rest)
        return from_wire(fields)
    return _unpacked(rest) if kind == _MAP else None


def _map(number: int, change: MapChanged) -> Parts:
    spec = change.spec
    head = msgspec.msgpack.encode(
        _MapHead(
            number=number,
            time_ns=change.time_ns,
            map_id=change.map_id,
            generation=change.generation,
            resolution_m=float(spec.resolution_m),
            origin_x_m=float(spec.origin_x_m),
            origin_y_m=float(spec.origin_y_m),
            rows=int(spec.rows),
            cols=int(spec.cols),
            whole=change.whole,
            stops=change.stops,
            changed=len(change.cells),
            is_packed=change.packed is not None,
        )
    )
    # Half the bytes of an index of this machine, and the same on each.
    cells = change.cells.astype(_INDEX).tobytes()
    values = np.ascontiguousarray(change.values, np.uint8).reshape(-1).data
    return _MAP, len(head).to_bytes(_LENGTH, "little"), head, cells, values if change.packed is None else change.packed


def _unpacked(data: memoryview) -> tuple[int, MapChanged] | MapChanged:
    length = int.from_bytes(data[:_LENGTH], "little")
    body = data[_LENGTH + length :]
    head = msgspec.msgpack.decode(data[_LENGTH : _LENGTH + length], type=_MapHead)
    spec = GridSpec(head.resolution_m, head.origin_x_m, head.origin_y_m, (head.rows, head.cols))
    cells = np.frombuffer(body[: head.changed * _INDEX.itemsize], _INDEX).astype(np.intp)
    rest = body[head.changed * _INDEX.itemsize :]
    values = np.frombuffer(b"" if head.is_packed else rest, np.uint8)
    change = MapChanged(
        time_ns=head.time_ns,
        map_id=head.map_id,
        generation=head.generation,
        spec=spec,
        whole=head.whole,
        cells=cells,
        values=values.reshape(spec.shape) if head.whole and not head.is_packed else values,
        stops=head.stops,
        packed=bytes(rest) if head.is_packed else None,
    )
    return change if head.number == _NO_NUMBER else (head.number, change)
