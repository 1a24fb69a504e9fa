"""What is taken for a stop: a request that says so, however badly it is made. Pure.

A stop is obeyed first and judged afterwards: who wants a robot to stop may be a program that fails, with a reason of
a whole traceback, in another version, in JSON. So whatever can be recognized as a stop stops the robot, and in doubt
it does: a request that cannot be read, or that asks for a command that does not exist, and speaks of stopping, is
one. What is no stop is a request for another command that exists, whatever stands in its arguments: a map may be
called ``stop``.
"""

import re
from typing import Any

import msgpack

from robotd.contract.requests import REQUESTS, Disarm, Stop

STOPPING = (Stop, Disarm)
"""The commands that stop the robot."""
_WORDS = tuple(kind.cmd.encode() for kind in STOPPING)
_OTHERS = {name.encode() for name in REQUESTS} - set(_WORDS)
_KEYS = {b"cmd", b"command"}
_NAMED = re.compile(rb"(?:cmd|command)[^a-z]{0,8}([a-z0-9_]+)")
"""Where unreadable bytes name a command: after the key, between whatever msgpack or JSON puts there."""
_ALONE = re.compile(rb"(?<![a-z0-9_])(?:%s)(?![a-z0-9_])" % b"|".join(_WORDS))
_LEAST_OF_A_WORD = 3
"""This many letters of a word that was cut off are enough: no other command begins with them."""


class Pairs(list[tuple[Any, Any]]):
    """A map as it was sent: in order, and with its duplicates."""

    __slots__ = ()


def means_stop(data: bytes) -> bool:
    """Return whether what a client sent is to be taken for a stop. Never raises; as long as it is, so long it takes."""
    if not isinstance(top := unpacked(data), Pairs | list | bytes):
        return _speaks_of_stopping(data)
    if isinstance(top, Pairs):
        return _map_says_stop(top, data)
    return any(_says_stop(item) for item in top) if isinstance(top, list) else _speaks_of_stopping(top)


def unpacked(data: bytes) -> Any:
    """Return msgpack as it is: text as bytes, maps as :class:`Pairs`; None if it is none."""
    try:
        return msgpack.unpackb(data, raw=True, strict_map_key=False, object_pairs_hook=Pairs)
    except (ValueError, TypeError, OverflowError, RecursionError):
        return None


def _map_says_stop(fields: Pairs, data: bytes) -> bool:
    commands = [value for key, value in fields if isinstance(key, bytes) and _plain(key) in _KEYS]
    if any(_says_stop(command) for command in commands) or any(_is_word(key) for key, _ in fields):
        return True
    # A command that exists is that command: a map may be called ``stop``, and saving it must not stop the
    # robot.
    if any(isinstance(command, bytes) and _plain(command) in _OTHERS for command in commands):
        return False
    # Whatever key it stands under: who writes it by hand may not know ours.
    return any(_is_word(value) for _, value in fields) or _speaks_of_stopping(data)


def _says_stop(command: object) -> bool:
    """Return whether what stands in the place of a command speaks of stopping: text, or text in a list or a map."""
    if isinstance(command, Pairs):
        return any(_is_word(key) or _is_word(value) for key, value in command)
    if isinstance(command, list):
        return any(_is_word(item) for item in command)
    return isinstance(command, bytes) and (_is_almost_a_word(_plain(command)) or _is_almost_a_word(command.lower()))


def _speaks_of_stopping(data: bytes) -> bool:
    plain = _plain(data)
    is_another = False
    for match in _NAMED.finditer(plain):
        name = match[1]
        if _is_almost_a_word(name) or (match.end() == len(plain) and _is_cut_off(name)):
            return True
        is_another = is_another or name in _OTHERS
    # As a word of its own: ``nonstop`` is none.
    return not is_another and _ALONE.search(plain) is not None


def _is_word(value: object) -> bool:
    return isinstance(value, bytes) and _plain(value) in _WORDS


def _is_almost_a_word(name: bytes) -> bool:
    """Return whether a command is a stop, or does not exist and has one letter wrong or other words around."""
    if name in _OTHERS:
        return False
    # With `record` in it, it is `record_stop` written wrongly, which ends no motion.
    return any(word in name or _one_letter_off(name, word) for word in _WORDS) and b"record" not in name


def _one_letter_off(name: bytes, word: bytes) -> bool:
    return len(name) == len(word) and sum(a == b for a, b in zip(name, word, strict=True)) == len(word) - 1


def _is_cut_off(name: bytes) -> bool:
    return len(name) >= _LEAST_OF_A_WORD and any(word.startswith(name) for word in _WORDS)


def _plain(data: bytes) -> bytes:
    """Return text in lower case, without the zeros of wider characters."""
    return data.replace(b"\0", b"").strip().lower()
