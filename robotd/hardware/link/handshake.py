"""How a session begins: who is there, does it speak our protocol, what shall it do, what time is it."""

import zlib
from dataclasses import dataclass

from firmware_proto.common import (
    DICTIONARY_CHUNK,
    PROTOCOL_MAJOR,
    PROTOCOL_MINOR,
    BoardKind,
    Configure,
    ConfigureReply,
    Hello,
    HelloReply,
    Identify,
    IdentifyReply,
)
from firmware_proto.dictionary import dictionary_for, missing_or_different, parse_dictionary
from robotd.core.errors import LinkTimeout, RemoteProtocolError
from robotd.hardware.link.session import Session

_HELLO_ROUNDS = 10
"""About three seconds: opening the port resets some boards, and their boot loader must end first."""
_QUICK_PINGS = 8
"""As PROTOCOL.md has it: from the start one slow or lying answer among them is outvoted."""


@dataclass(frozen=True, slots=True)
class Terms:
    """What we ask of a board."""

    kind: BoardKind
    telemetry_ms: int
    """Period of its telemetry."""
    ttl_max_ms: int
    """Longest time that it may go on with a motion without hearing from us."""


async def shake_hands(session: Session, terms: Terms, nonce: int, dictionaries: dict[int, bytes]) -> None:
    """Open a session: HELLO, IDENTIFY, CONFIGURE, and eight pings. It leaves the board disarmed.

    Args:
        session: a fresh one.
        terms: what the board must be and do.
        nonce: 32 bits that no earlier session used.
        dictionaries: those read before, by CRC-32; a new one is added.

    Raises:
        RemoteProtocolError: another device, another version, or a damaged answer; the message says which.
        LinkTimeout, TransportError, DeviceError: as for any request.
    """
    hello = await _hello(session, nonce)
    # Before Configure: a layout that has drifted is what no checksum notices, and reading alone is safe.
    _check_dictionary(session.device, terms.kind, await _dictionary(session, hello, dictionaries))
    await _configure(session, Configure(terms.telemetry_ms, terms.ttl_max_ms))
    # Before anything is asked of the board in earnest: telemetry would have no time of ours until the clock is
    # known.
    for _ in range(_QUICK_PINGS):
        await session.ping()
    if session.clock.best is None:
        raise RemoteProtocolError(f"{session.device}: no answer to a ping tells the board's time")
    session.boot_id = hello.boot_id


async def _hello(session: Session, nonce: int) -> HelloReply:
    reply = await _patiently_say(session, Hello(PROTOCOL_MAJOR, PROTOCOL_MINOR, nonce))
    if reply.nonce != nonce:  # a late answer to the HELLO of an older session
        raise RemoteProtocolError(f"{session.device}: answered another HELLO than ours")
    if reply.major != PROTOCOL_MAJOR:
        theirs, ours = f"{reply.major}.{reply.minor}", f"{PROTOCOL_MAJOR}.{PROTOCOL_MINOR}"
        raise RemoteProtocolError(f"{session.device}: the board speaks protocol {theirs}, we speak {ours}")
    return reply


async def _patiently_say(session: Session, hello: Hello) -> HelloReply:
    for _ in range(_HELLO_ROUNDS - 1):
        try:
            return await session.ask(hello, HelloReply)
        except LinkTimeout:
            continue
    return await session.ask(hello, HelloReply)


async def _dictionary(session: Session, hello: HelloReply, known: dict[int, bytes]) -> bytes:
    # Known by its checksum, not by the board: a reconnection is quick, and another board is still read.
    if hello.dictionary_crc32 in known:
        return known[hello.dictionary_crc32]
    data = b""
    while len(data) < hello.dictionary_size:
        reply = await session.ask(Identify(len(data)), IdentifyReply)
        if reply.offset != len(data):
            raise RemoteProtocolError(f"{session.device}: gave another piece of its dictionary than we asked for")
        data += reply.data[: min(DICTIONARY_CHUNK, hello.dictionary_size - len(data))]  # zeros fill the last piece
    if zlib.crc32(data) != hello.dictionary_crc32:
        raise RemoteProtocolError(f"{session.device}: its dictionary does not fit its checksum")
    known[hello.dictionary_crc32] = data
    return data


def _check_dictionary(device: str, kind: BoardKind, theirs: bytes) -> None:
    try:
        differences = missing_or_different(parse_dictionary(theirs), parse_dictionary(dictionary_for(kind)))
    except ValueError as error:
        raise RemoteProtocolError(f"{device}: {error}") from error
    if differences:
        more = f" (and {len(differences) - 1} more)" if len(differences) > 1 else ""
        raise RemoteProtocolError(f"{device}: {differences[0]}{more}")


async def _configure(session: Session, configure: Configure) -> None:
    reply = await session.ask(configure, ConfigureReply)
    # Told back as a checksum: a board that has taken over another ``ttl_max_ms`` would let motions live too
    # long.
    if reply.config_crc32 != zlib.crc32(configure.to_payload()):
        raise RemoteProtocolError(f"{session.device}: took over another configuration than ours")
