"""What the log says of requests: who asked for what that changes something, and what came of it. One line each."""

import logging
from typing import Any

import msgspec

from robotd.contract.answers import MapEntryInfo, MissionStarted, RecordingFile
from robotd.contract.map_import import MapImported
from robotd.contract.request import Request
from robotd.contract.stopping import STOPPING
from robotd.core.errors import ServerError
from robotd.core.log_limit import LogLimit
from robotd.core.text import printable

_BURST = 20

log = logging.getLogger(__name__)


class RequestLog:
    """Notes requests, each kind of line within bounds: a client that floods must not hide what the others do."""

    def __init__(self) -> None:
        # One limit for each kind: a client that is refused without end must not hide a stop.
        self._stops = LogLimit(burst=_BURST)
        self._done = LogLimit(burst=_BURST)
        self._refused = LogLimit(burst=_BURST)

    def obeyed(self, sender: str, request: Request[Any]) -> None:
        """Note a stop, which was obeyed."""
        _say(self._stops, f"{sender}: {in_words(request)}")

    def done(self, sender: str, request: Request[Any], result: object) -> None:
        """Note what was done; what only looks goes without saying, and a stop was noted."""
        is_part = isinstance(result, MapImported) and result.map is None  # of which there may be thousands
        if not (request.only_looks or is_part or isinstance(request, STOPPING)):
            _say(self._done, f"{sender}: {in_words(request)}: {_came_to(result)}")

    def refused(self, sender: str, request: Request[Any], error: ServerError) -> None:
        """Note what was not done, and why."""
        _say(self._refused, f"{sender}: {in_words(request)}: {printable(str(error))}")


def in_words(request: Request[Any]) -> str:
    """Return a request with what it asks beyond the defaults.

    >>> from robotd.contract.missions import DriveTo
    >>> in_words(DriveTo(1.5, 2.0))
    'drive_to x_m=1.5 y_m=2.0'
    """
    defaults = {field.name: field.default for field in msgspec.structs.fields(type(request))}
    asked = {name: value for name, value in msgspec.structs.asdict(request).items() if value != defaults[name]}
    plain = {name: _shown(value) for name, value in asked.items()}
    return printable(" ".join((request.cmd, *(f"{name}={value}" for name, value in plain.items()))), 300)


def _shown(value: object) -> object:
    return f"<{len(value)} bytes>" if isinstance(value, bytes) else msgspec.to_builtins(value)


def _came_to(result: object) -> str:
    match result:
        case MissionStarted():
            return f"mission {result.mission_id}, lease {result.lease_s:g} s"
        case MapEntryInfo():
            return f"map {result.name} version {result.version}"
        case MapImported(map=MapEntryInfo() as entry):
            return _came_to(entry)
        case RecordingFile():
            return printable(str(result.path or "there was no recording"))
    return "done"


def _say(limit: LogLimit, line: str) -> None:
    if (allowed := limit.line(line)) is not None:
        log.info("%s", allowed)
