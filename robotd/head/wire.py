"""Jobs and their answers as bytes, for a head in another process; one in this process is spoken to by the same.

A job is ``[name, fields]``, an answer ``[fields]`` or ``[null, kind, text, traceback]`` of
an error, both msgpack. What comes in is checked by its types: it is from a process that may have gone mad.
"""

import traceback
from typing import Any

import msgspec

from robotd.core.errors import MapError, MissionError, RemoteProtocolError, RobotdError, TooLarge
from robotd.head.job import A, Job
from robotd.head.job_names import JOBS

NUMBER = 8
"""Bytes of the number of a job, which goes before it and before its answer."""
_ERRORS: dict[str, type[RobotdError]] = {
    kind.__name__: kind for kind in (MapError, MissionError, TooLarge, RobotdError)
}
_NULL = msgspec.Raw(msgspec.msgpack.encode(None))
_LONGEST_TEXT = 2000
"""Letters of an error."""


class NotHeld(LookupError):
    """Somebody asked for a map, or a stop, of a number that nobody gave, or that was forgotten."""


class JobFailed(Exception):
    """A job ended with an error that nobody foresaw, a mistake of ours; says which, and where."""


class _Sent(msgspec.Struct, array_like=True, frozen=True):
    name: str
    fields: msgspec.Raw


class _Answered(msgspec.Struct, array_like=True, frozen=True):
    fields: msgspec.Raw
    kind: str = ""
    text: str = ""
    where: str = ""


def pack_job(job: Job[Any]) -> bytes:
    """Return a job as bytes."""
    return msgspec.msgpack.encode((job.name, job))


def unpack_job(data: bytes | memoryview) -> Job[Any]:
    """Return the job of these bytes.

    Raises:
        RemoteProtocolError: it is none.
    """
    try:
        sent = msgspec.msgpack.decode(data, type=_Sent)
        job: Job[Any] = msgspec.msgpack.decode(sent.fields, type=JOBS[sent.name])
    except (msgspec.MsgspecError, KeyError, ValueError) as error:
        raise RemoteProtocolError(f"no job: {str(error)[:_LONGEST_TEXT]}") from error
    return job


def pack_answer(answer: object) -> bytes:
    """Return an answer as bytes."""
    return msgspec.msgpack.encode((answer,))


def pack_error(error: Exception) -> bytes:
    """Return what went wrong as bytes."""
    name = type(error).__name__
    # By the very class: another one of the same name would be raised here as what it is not.
    kind = name if _ERRORS.get(name) is type(error) or isinstance(error, NotHeld) else ""
    # An error that nobody foresaw may have no text: its kind is then all there is.
    text = str(error) if kind else repr(error)
    where = "" if kind else "".join(traceback.format_exception(error))[-_LONGEST_TEXT:]
    return msgspec.msgpack.encode((None, kind, text[:_LONGEST_TEXT], where))


def unpack_answer(kind: type[Job[A]], data: bytes | memoryview) -> A:
    """Return the answer of a job of a kind.

    Raises:
        RobotdError: the job could not be done; says why.
        JobFailed: it ended with an error that nobody foresaw.
        RemoteProtocolError: these bytes are no answer of this job, or who answers has lost what it held.
    """
    try:
        answered = msgspec.msgpack.decode(data, type=_Answered)
        if answered.fields != _NULL:
            answer: A = msgspec.msgpack.decode(answered.fields, type=kind.answer)
            return answer
    except (msgspec.MsgspecError, ValueError) as error:
        raise RemoteProtocolError(f"no answer of {kind.name!r}: {str(error)[:_LONGEST_TEXT]}") from error
    if answered.kind in _ERRORS:
        raise _ERRORS[answered.kind](answered.text)
    if answered.kind == NotHeld.__name__:
        raise RemoteProtocolError(answered.text)
    failed = JobFailed(answered.text)
    # Where it was raised is another process, whose frames end there: they come along as text.
    failed.add_note(answered.where)
    raise failed
