"""ZeroMQ's bytes: whole, byte by byte, after garbage, and beyond every bound. The vectors are of a real libzmq."""

import contextlib
import socket
import threading
from pathlib import Path

import pytest
import zmq
from hypothesis import given
from hypothesis import strategies as st

from robotd.server.zmtp import GREETING, Message, Peer, Ping, Reader, Said, Violation, message, pong, ready

HELLO = GREETING + ready(b"DEALER")


def reader(longest_bytes: int = 10_000, most_frames: int = 4) -> Reader:
    return Reader(longest_bytes=longest_bytes, most_frames=most_frames)


def said(data: bytes, size: int = 2**20) -> list[Said]:
    one = reader()
    return [what for at in range(0, len(data), size) for what in one.feed(data[at : at + size])]


@given(
    st.lists(st.lists(st.binary(max_size=600), min_size=1, max_size=4).map(tuple), max_size=5),
    st.integers(1, 700),
)
def test_messages_come_out_as_they_went_in_whatever_the_pieces(messages: list[tuple[bytes, ...]], size: int) -> None:
    data = HELLO + b"".join(message(*frames) for frames in messages)
    assert said(data, size) == [Peer(b"DEALER", b""), *map(Message, messages)]


@pytest.mark.parametrize("kind", [zmq.DEALER, zmq.REQ, zmq.SUB])
def test_what_libzmq_sends_is_understood_and_it_understands_us(tmp_path: Path, kind: zmq.SocketType) -> None:
    path = tmp_path / "it.sock"
    name = {zmq.DEALER: b"DEALER", zmq.REQ: b"REQ", zmq.SUB: b"SUB"}[kind]
    found: list[Said] = []

    def serve(listening: socket.socket) -> None:
        end, _ = listening.accept()
        one = reader()
        with end:
            end.sendall(GREETING + ready(b"XPUB" if kind == zmq.SUB else b"ROUTER"))
            while len(found) < 2:
                found.extend(one.feed(end.recv(7)))
            end.sendall(message(b"pose\0x") if kind == zmq.SUB else message(b"", b"answer"))

    with socket.socket(socket.AF_UNIX) as listening, zmq.Context() as context, context.socket(kind) as client:
        listening.bind(str(path))
        listening.listen()
        serving = threading.Thread(target=serve, args=(listening,))
        serving.start()
        client.setsockopt(zmq.LINGER, 0)
        client.setsockopt(zmq.RCVTIMEO, 30_000)
        client.setsockopt(zmq.IDENTITY, b"me")
        client.connect(f"ipc://{path}")
        if kind == zmq.SUB:
            client.subscribe(b"pose\0")
        else:
            client.send(b"request")
        assert client.recv_multipart()[-1] in {b"answer", b"pose\0x"}
        serving.join()
    assert found[0] == Peer(name, b"me" if kind != zmq.SUB else found[0].identity)  # type: ignore[union-attr]  # it is one
    expected = {zmq.DEALER: (b"request",), zmq.REQ: (b"", b"request"), zmq.SUB: (b"\x01pose\0",)}[kind]
    assert found[1] == Message(expected)


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        (b"GET / HTTP/1.1\r\n", "does not speak ZeroMQ"),
        (b"\xff" + bytes(9), "does not speak ZeroMQ"),
        (b"\xff" + bytes(8) + b"\x7f\x01", "speaks version 1"),
        (GREETING[:12] + b"CURVE".ljust(20, b"\0") + bytes(32), "wants security by b'CURVE'"),
        (GREETING + message(b"early"), "not said what it is"),
        (HELLO + ready(b"DEALER"), "command b'READY'"),
        (HELLO + b"\x04\x03\x02NO", "command b'NO'"),
        (HELLO + b"\xf8\x00", "a frame with flags 0xf8"),
        (HELLO + b"\x02" + (2**63).to_bytes(8, "big"), "expected at most 10000"),
        (HELLO + b"\x06" + (2**20).to_bytes(8, "big"), "a command of 1048576 bytes"),
        (HELLO + b"\x01\x01x" * 5, "more than 4 frames"),
        (HELLO + message(b"x" * 6000, b"y" * 6000), "a message of 12000 bytes"),
        (GREETING + b"\x04\x0d\x05READY\x03abc\xff\xff\xff", "a property without its end"),
    ],
)
def test_what_breaks_the_rules_or_a_bound_is_refused_at_once(data: bytes, complaint: str) -> None:
    for size in (1, len(data)):
        with pytest.raises(Violation, match=complaint):
            said(data, size)


def test_what_came_of_a_message_that_is_too_much_can_be_looked_at() -> None:
    with pytest.raises(Violation) as caught:
        said(HELLO + b"\x01\x04stop" + b"\x01\x01x" * 5)
    assert caught.value.frames[0] == b"stop"


def test_it_is_asked_whether_we_live() -> None:
    (_, ping) = said(HELLO + b"\x04\x0b\x04PING\x00\x0aabcd")
    assert ping == Ping(b"abcd")
    assert pong(ping) == b"\x04\x09\x04PONGabcd"


@given(st.binary(max_size=300), st.booleans())
def test_whatever_comes_is_taken_or_refused(data: bytes, greeted: bool) -> None:
    with contextlib.suppress(Violation):
        said((HELLO if greeted else b"") + data, 11)
