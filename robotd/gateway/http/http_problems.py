"""Problems as objects: ``{code, message, where}``, whatever went wrong."""

from aiohttp import web

from robotd.core.errors import ServerError

_STATUS = {
    "malformed": 400,
    "bad_argument": 400,
    "unknown_command": 404,
    "not_found": 404,
    "not_signed_in": 401,
    "wrong_token": 401,
    "not_allowed": 403,
    "wrong_origin": 403,
    "wrong_host": 421,
    "refused": 409,
    "too_large": 413,
    "too_many_tries": 429,
    "too_many": 429,
    "busy": 503,
    "full": 503,
    "no_daemon": 503,
    "outcome_unknown": 504,
    "not_confirmed": 504,
}


def problem(error: ServerError, where: str) -> web.Response:
    """Return the answer to a request that was not carried out."""
    body = {"code": str(error.code), "message": error.message, "where": where}
    return web.json_response(body, status=_STATUS.get(str(error.code), 500))


def of_status(status: int, reason: str, where: str) -> web.Response:
    """Return what the web server itself refuses, as ours."""
    code = {404: "not_found", 405: "bad_method", 413: "too_large"}.get(status, "refused")
    return web.json_response({"code": code, "message": reason, "where": where}, status=status)
