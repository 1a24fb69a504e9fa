"""Errors as clients see them."""

from robotd.contract.answers import ErrorCode
from robotd.core.errors import ConfigError, MapError, RobotdError, ServerError

_CODES: tuple[tuple[type[RobotdError], ErrorCode], ...] = (
    (MapError, ErrorCode.NOT_FOUND),
    (ConfigError, ErrorCode.BAD_ARGUMENT),
    (RobotdError, ErrorCode.REFUSED),  # last, for all the others are of its kind too
)


def as_refusal(error: RobotdError) -> ServerError:
    """Return the reply to a request that ended with an error."""
    if isinstance(error, ServerError):
        return error
    return ServerError(next(code for kind, code in _CODES if isinstance(error, kind)), str(error))
