"""Everything robotd raises on purpose.

::

    RobotdError
    ├── ConfigError            a key of the configuration is unknown, missing or impossible
    │   └── ConfigErrors           all that is wrong with one configuration
    ├── TransportError         the port is gone, busy, or not what it should be
    ├── ProtocolError
    │   ├── LocalProtocolError     we misused the protocol
    │   └── RemoteProtocolError    the board did, or it is not the board we expect
    ├── LinkTimeout            the board did not answer in time
    ├── DeviceError            the board answered that it will not, or reported a fault
    ├── MissionError           the request cannot be done now; says why
    ├── CalibrationError       what was seen does not tell the constants; says why
    ├── MapError               a stored map is missing or damaged; says what
    ├── TooLarge               it would take more memory than it may; says how much
    ├── RecordingError         a recording is missing or damaged; says what and where
    ├── ChildError             a process that works for this one is gone, or is not what it should be; says why
    ├── ServerError            the server refused; carries its error code
    └── RequestTimeout         the server did not answer in time

Damaged bytes on a line are data: counted, and resynchronized. "No feasible pose" and "no path" are
results with their evidence. Exceptions are for what a caller cannot foresee.
"""

from functools import partial


class RobotdError(Exception):
    """Base of everything robotd raises on purpose."""


class ConfigError(RobotdError):
    """A key of the configuration is unknown, missing, of the wrong type or impossible."""

    def __init__(self, message: str, *, file: str = "", line: int | None = None, key: str = "") -> None:
        where = ":".join(part for part in (file, "" if line is None else str(line)) if part)
        super().__init__(": ".join(part for part in (where, key, message) if part))
        self.file = file
        self.line = line
        self.key = key
        self.message = message
        self.problems: tuple[ConfigError, ...] = (self,)
        """Everything that is wrong, one line each."""

    def __reduce__(self) -> tuple[object, ...]:
        """Come out of another process as it went in."""
        return partial(type(self), self.message, file=self.file, line=self.line, key=self.key), ()


class ConfigErrors(ConfigError):
    """All that is wrong with one configuration; its text has a line for each problem."""

    def __init__(self, problems: tuple[ConfigError, ...]) -> None:
        super().__init__("\n".join(map(str, problems)), key="")
        self.file, self.line = problems[0].file, problems[0].line
        self.problems = problems

    def __reduce__(self) -> tuple[object, ...]:
        """Come out of another process as it went in."""
        return type(self), (self.problems,)


class TransportError(RobotdError):
    """The port is gone, busy, or not what it should be."""


class ProtocolError(RobotdError):
    """The rules of the wire were broken."""


class LocalProtocolError(ProtocolError):
    """We misused the protocol."""


class RemoteProtocolError(ProtocolError):
    """The board broke the protocol, or it is not the board we expect."""


class LinkTimeout(RobotdError):
    """The board did not answer in time."""


class DeviceError(RobotdError):
    """The board answered that it will not, or reported a fault."""

    def __init__(self, device: str, code: str, message: str = "") -> None:
        super().__init__(f"{device}: {code}" + (f": {message}" if message else ""))
        self.device = device
        self.code = code
        self._given = device, code, message

    def __reduce__(self) -> tuple[type["DeviceError"], tuple[str, str, str]]:
        """Come out of another process as it went in: by default only the text would be handed on."""
        return type(self), self._given


class MissionError(RobotdError):
    """The request cannot be done now; the message says why."""


class CalibrationError(RobotdError):
    """What was seen does not tell the constants that were sought; the message says why, and what would help."""


class MapError(RobotdError):
    """A stored map is missing or damaged; the message says which part."""


class TooLarge(RobotdError):
    """It would take more memory than it may; says how much."""


class RecordingError(RobotdError):
    """A recording is missing or damaged; the message says what and where."""


class ChildError(RobotdError):
    """A process that works for this one is gone, or is not what it should be; the message says why."""


class ServerError(RobotdError):
    """The server refused a request."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(f"{code}: {message}")
        self.code = code
        self.message = message

    def __reduce__(self) -> tuple[type["ServerError"], tuple[str, str]]:
        """Come out of another process as it went in."""
        return type(self), (self.code, self.message)


class RequestTimeout(RobotdError):
    """The server did not answer in time."""
