"""What pages and the gateway say to each other as text, ``robotd.console.v1``; the daemon's frames go beside as bytes.

A binary message is the byte ``FRAME`` and then a frame of the daemon, as it is.
"""

from typing import Any

import msgspec

from robotd.contract.stopping import means_stop
from robotd.core.errors import ServerError

SUBPROTOCOL = "robotd.console.v1"
FRAME = b"\x01"
LONGEST_TEXT = 64 * 1024
TEXTS_PER_S = 20.0
"""That are no stop."""


class Answer(msgspec.Struct, tag="answer", tag_field="type", forbid_unknown_fields=True):
    """The page's main thread is alive."""

    n: int


class StopNow(msgspec.Struct, tag="stop", tag_field="type"):
    """Stop the robot. What else is said with it does not matter."""

    id: int = 0


class Command(msgspec.Struct, tag="command", tag_field="type", forbid_unknown_fields=True):
    """Send a request to the daemon."""

    id: int
    cmd: str
    args: dict[str, Any] = {}


class StartMission(msgspec.Struct, tag="mission", tag_field="type", forbid_unknown_fields=True):
    """Start a mission, under a lease that the gateway renews for the page."""

    id: int
    cmd: str
    args: dict[str, Any] = {}
    attended: bool = True


class TakeOver(msgspec.Struct, tag="take_over", tag_field="type", forbid_unknown_fields=True):
    """Ask who drives to hand over."""

    id: int


class HandOver(msgspec.Struct, tag="hand_over", tag_field="type", forbid_unknown_fields=True):
    """Give the mission to who asks, or keep it."""

    id: int
    give: bool


class ShowLayers(msgspec.Struct, tag="look", tag_field="type", forbid_unknown_fields=True):
    """Show the heat map, or no more."""

    rank: bool


Said = Answer | ShowLayers | StopNow | Command | StartMission | TakeOver | HandOver


def said(text: str) -> Said:
    """Return what a page says. What cannot be read and speaks of a stop is one.

    Raises:
        ServerError: it is nothing that a page may say.
    """
    try:
        return msgspec.json.decode(text, type=Said)
    except (msgspec.DecodeError, RecursionError) as error:
        if means_stop(text.encode("utf-8", "replace")):
            return StopNow()
        raise ServerError("malformed", f"not a message of {SUBPROTOCOL}: {error}") from error


def hello(**fields: Any) -> str:
    """Say to a page who it talks to."""
    return _text("hello", fields)


def question(n: int, daemon_silent_s: float | None, time_ns: int) -> str:
    """Ask a page whether it lives, and tell how long ago the daemon was heard."""
    return _text("question", {"n": n, "daemon_silent_s": daemon_silent_s, "time_ns": time_ns})


def result(request_id: int, value: object) -> str:
    """Answer a request that was carried out."""
    return _text("result", {"id": request_id, "result": value})


def problem(request_id: int | None, error: ServerError) -> str:
    """Answer one that was not."""
    return _text("problem", {"id": request_id, "code": str(error.code), "message": error.message})


def stopped(request_id: int, took_s: float) -> str:
    """Say that the daemon confirmed a stop, and after how long."""
    return _text("stopped", {"id": request_id, "took_ms": round(took_s * 1000.0, 1)})


def commander(**fields: Any) -> str:
    """Say who drives, and who wants to."""
    return _text("commander", fields)


def lost(topics: dict[str, int]) -> str:
    """Say how many messages of which topics were left out."""
    return _text("lost", {"topics": topics})


def _text(kind: str, fields: dict[str, Any]) -> str:
    return msgspec.json.encode({"type": kind, **fields}).decode()
