"""Requests and replies as bytes, both ways, pure.

A request is the msgpack map ``{v, id, cmd, args}``, and may have a ``client``, who asks; a reply is ``{v, id, ok: true,
result}`` or ``{v, id, ok: false, error: {code, message}}``. What comes from a client is never trusted: size, nesting,
duplicate keys, types, ranges and finiteness are checked before anything sees it, and what fails is answered, not
raised. A stop is what :mod:`robotd.contract.stopping` takes for one, whatever else is wrong with it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgpack
import msgspec

from robotd.contract.answers import ErrorCode
from robotd.contract.plain import VERSION, to_plain
from robotd.contract.request import Request
from robotd.contract.requests import REQUESTS, Stop
from robotd.contract.stopping import Pairs, means_stop, unpacked
from robotd.core.errors import RemoteProtocolError, ServerError
from robotd.core.text import printable

_MAX_DEPTH = 6
_MAX_ITEMS = 2048
"""Of a list; the longest that a request needs are the 1000 stops of a map."""
_MAX_KEYS = 64
_MAX_ID = 2**63 - 1
_LONGEST_MESSAGE = 1000
"""Letters of an error's message: what it quotes may be anything, and endless."""
_KEYS = {"v", "id", "cmd", "args"}
LONGEST_CLIENT = 64


@dataclass(frozen=True, slots=True)
class NumberedRequest:
    """A request that says what it wants, with the number that its answer will have."""

    id: int
    request: Request[Any]
    client: str = ""
    """Who asks, as it calls itself, printable; empty if it does not say."""


@dataclass(frozen=True, slots=True)
class BadRequest:
    """A request that does not; the error is the answer."""

    id: int | None
    """Its number, if at least that could be read."""
    error: ServerError
    means_stop: bool = False
    """Whether it is a stop all the same, to be obeyed before it is answered."""


@dataclass(frozen=True, slots=True)
class Reply:
    """An answer, as the client sees it."""

    id: int | None
    result: dict[str, Any] | ServerError


def decode_request(
    data: bytes, max_bytes: int, known: Mapping[str, type[Request[Any]]] = REQUESTS
) -> NumberedRequest | BadRequest:
    """Return what a client asks. Never raises; time and memory are bounded by the length of ``data``."""
    request_id = None
    try:
        fields = _unpack(data, max_bytes)
        # First of all that is read: an answer without its number would leave its client waiting.
        request_id = _id_of(fields)
        # After the number: so what is refused from here on names the request that it answers.
        _check(fields, _MAX_DEPTH)
        request, client = _request_of(fields, known), _client_of(fields)
    except ServerError as error:
        # In this order: a stop whose reason alone is odd is a good one, and is answered as such.
        return _stop_for_an_odd_reason(data) or _bad(request_id, error, means_stop=means_stop(data))
    if request_id is None:
        nameless = ServerError(ErrorCode.MALFORMED, "id must be a whole number from 0 to 2^63 - 1")
        return _bad(None, nameless, means_stop=means_stop(data))
    return NumberedRequest(request_id, request, client)


def refuse_frames(frames: Sequence[bytes]) -> BadRequest:
    """Return what is answered to a request of several frames."""
    error = ServerError(ErrorCode.MALFORMED, f"a request is one frame, this one has {len(frames)}")
    return _bad(None, error, means_stop=any(map(means_stop, frames)))


def _bad(request_id: int | None, error: ServerError, *, means_stop: bool) -> BadRequest:
    note = "; it speaks of a stop, so the robot was stopped" if means_stop else ""
    return BadRequest(request_id, ServerError(error.code, f"{error.message}{note}"), means_stop)


def _stop_for_an_odd_reason(data: bytes) -> NumberedRequest | None:
    """Return a stop that is as it should be but for its reason: too long, bytes, no text at all."""
    top = unpacked(data)
    if not isinstance(top, Pairs):
        return None
    try:
        fields = {key.decode(): value for key, value in top if key != b"client"}
        if len(fields) != len(_KEYS):
            return None
        request_id, arguments = _id_of(fields), dict(fields["args"])
    except (AttributeError, KeyError, TypeError, ValueError):
        return None
    is_one = (fields.get("cmd"), fields.get("v")) == (Stop.cmd.encode(), VERSION) and type(fields["v"]) is int
    if request_id is None or not is_one or list(arguments) != [b"reason"]:
        return None
    return NumberedRequest(request_id, Stop.because(arguments[b"reason"]))


def encode_request(request_id: int, request: Request[Any], client: str = "") -> bytes:
    """Return a request; ``client`` says who asks, if it is to be said."""
    named = {"client": client} if client else {}
    return _pack({"v": VERSION, "id": request_id, "cmd": request.cmd, "args": to_plain(request), **named})


def encode_result(request_id: int, result: object) -> bytes:
    """Return the reply to a request that was carried out."""
    return _pack({"v": VERSION, "id": request_id, "ok": True, "result": to_plain(result)})


def encode_error(request_id: int | None, error: ServerError) -> bytes:
    """Return the reply to a request that was not."""
    problem = {"code": error.code, "message": printable(error.message, _LONGEST_MESSAGE)}
    return _pack({"v": VERSION, "id": request_id, "ok": False, "error": problem})


def decode_reply(data: bytes) -> Reply:
    """Return a server's answer.

    Raises:
        RemoteProtocolError: it is none.
    """
    try:
        fields = msgpack.unpackb(data)
        if fields["v"] != VERSION:
            raise RemoteProtocolError(f"the server speaks version {fields['v']}, this client {VERSION}")
        if fields["ok"]:
            return Reply(fields["id"], dict(fields["result"]))
        return Reply(fields["id"], ServerError(str(fields["error"]["code"]), str(fields["error"]["message"])))
    except (ValueError, KeyError, TypeError) as error:
        raise RemoteProtocolError(f"not a reply: {error!r}") from error


def _pack(fields: dict[str, Any]) -> bytes:
    packed: bytes = msgpack.packb(fields)
    return packed


def _unpack(data: bytes, max_bytes: int) -> dict[str, Any]:
    if len(data) > max_bytes:
        raise ServerError(ErrorCode.TOO_LARGE, f"a request may have {max_bytes} bytes, this one has {len(data)}")
    try:
        fields = msgpack.unpackb(
            data,
            # Of two keys alike another reader may take the other one: what was checked would not be what is
            # done.
            object_pairs_hook=_without_duplicates,
            max_str_len=max_bytes,
            max_bin_len=max_bytes,
            max_ext_len=0,  # no argument is of such a type
            max_array_len=_MAX_ITEMS,
            max_map_len=_MAX_KEYS,
        )
    except ValueError as error:
        raise ServerError(ErrorCode.MALFORMED, f"not msgpack: {str(error) or type(error).__name__}") from error
    if not isinstance(fields, dict):
        raise ServerError(ErrorCode.MALFORMED, "a request is a map of v, id, cmd and args")
    return fields


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key stands there twice")
    return found


def _check(value: object, depth: int) -> None:
    if isinstance(value, float) and not math.isfinite(value):
        raise ServerError(ErrorCode.BAD_ARGUMENT, f"numbers must be finite, got {value}")
    if not isinstance(value, dict | list):
        return
    # Bounded here and not by the reader: its own bound is the stack of this process.
    if depth == 0:
        raise ServerError(ErrorCode.MALFORMED, f"nested more than {_MAX_DEPTH} deep")
    for item in value.values() if isinstance(value, dict) else value:
        _check(item, depth - 1)


def _id_of(fields: dict[str, Any]) -> int | None:
    request_id = fields.get("id")
    # Not isinstance: to Python True is a whole number, on the wire it is none.
    return request_id if type(request_id) is int and 0 <= request_id <= _MAX_ID else None


def _request_of(fields: dict[str, Any], known: Mapping[str, type[Request[Any]]]) -> Request[Any]:
    version = fields.get("v")
    if type(version) is not int or version != VERSION:
        raise ServerError(ErrorCode.UNSUPPORTED_VERSION, f"this server speaks version {VERSION}, got {_shown(version)}")
    if unknown := [key for key in fields if key not in _KEYS and key != "client"]:
        has = "a request has v, id, cmd and args, and may have a client"
        raise ServerError(ErrorCode.MALFORMED, f"unknown key {_shown(unknown[0])}: {has}")
    name = fields.get("cmd")
    kind = known.get(name) if isinstance(name, str) else None
    if kind is None:
        raise ServerError(ErrorCode.UNKNOWN_COMMAND, f"no command {_shown(name)}; there are {', '.join(REQUESTS)}")
    try:
        request: Request[Any] = msgspec.convert(_arguments_of(fields), kind, strict=True)
    except msgspec.ValidationError as error:
        raise ServerError(ErrorCode.BAD_ARGUMENT, f"{name}: {_in_words(error)}") from error
    # Made again by its own rule, which cuts the reason and makes it printable: no other stop reaches the
    # mission.
    return Stop.because(request.reason) if isinstance(request, Stop) else request


def _client_of(fields: dict[str, Any]) -> str:
    client = fields.get("client") or ""
    if not isinstance(client, str) or len(client) > LONGEST_CLIENT:
        expected = f"client must be a text of up to {LONGEST_CLIENT} letters"
        raise ServerError(ErrorCode.BAD_ARGUMENT, f"{expected}, got {_shown(client)}")
    return printable(client, LONGEST_CLIENT)


def _arguments_of(fields: dict[str, Any]) -> Any:
    """Return the arguments; nothing, nil and the empty list are none, which some languages cannot tell apart."""
    arguments = fields.get("args")
    return {} if arguments is None or arguments == [] else arguments


def _in_words(error: msgspec.ValidationError) -> str:
    """Return what is wrong with which argument; msgspec names it last, as a path from ``$``."""
    what, _, path = str(error).partition(" - at `$")
    return printable(f"{path.strip('.`')}: {what}" if path else what)


def _shown(value: object) -> str:
    return printable(repr(value), 50)
