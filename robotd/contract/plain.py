"""What goes over the wire as maps, lists, numbers and text, and back: the one place that knows both forms."""

from typing import Any, TypeVar

import msgspec
import numpy as np

from robotd.contract.events import MapChanged
from robotd.contract.map_wire import MapPayload, pack_map, unpack_map

VERSION = 1
"""Major version of the wire: carried by every message, refused when it is not ours."""

T = TypeVar("T")


def to_plain(value: object) -> Any:
    """Return a request, an answer or an event as maps, lists and numbers; ``bytes`` stay what they are.

    A whole map is compressed, which takes milliseconds: do it off the loop.
    """
    shown = pack_map(value) if isinstance(value, MapChanged) else value
    # msgspec would write bytes as base64, for JSON's sake; msgpack has a type for them.
    return msgspec.to_builtins(shown, builtin_types=(bytes,), enc_hook=_number)


def from_plain(kind: type[T], fields: object) -> T:
    """Return what was sent.

    Raises:
        ValueError: it is no ``kind``.
        RemoteProtocolError: it is a map that contradicts itself.
    """
    if kind is MapChanged:
        return unpack_map(msgspec.convert(fields, MapPayload, strict=True))  # type: ignore[return-value]  # T is it
    # Strict: a number sent as text is a mistake of its sender, and taking it would hide that.
    return msgspec.convert(fields, kind, strict=True)


def _number(value: object) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise NotImplementedError(f"{type(value).__name__} has no place on the wire")
