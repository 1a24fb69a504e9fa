"""Messages in a stream: whole, byte by byte, of length zero, and too long."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.children.message_framing import Unframer, header
from robotd.core.errors import RemoteProtocolError


def framed(message: bytes) -> bytes:
    return header(len(message)) + message


@given(st.lists(st.binary(max_size=40), max_size=8), st.integers(1, 50))
def test_messages_come_out_as_they_went_in_whatever_the_pieces(messages: list[bytes], size: int) -> None:
    stream = b"".join(map(framed, messages))
    unframer = Unframer()
    found = [one for at in range(0, len(stream), size) for one in unframer.feed(stream[at : at + size])]
    assert found == messages


def test_a_message_that_comes_in_pieces_is_not_joined_when_it_is_whole() -> None:
    unframer = Unframer()
    stream = framed(bytes(range(256)) * 16) + framed(b"next")
    assert not list(unframer.feed(stream[:100]))
    assert not list(unframer.feed(stream[100:4000]))
    long, after = unframer.feed(stream[4000:])
    assert isinstance(long, memoryview)
    assert long.readonly
    assert long.obj is not stream
    assert [long, after] == [bytes(range(256)) * 16, b"next"]


def test_a_length_beyond_the_bound_is_refused_before_its_bytes_come() -> None:
    unframer = Unframer(longest=10)
    assert list(unframer.feed(framed(b"ten letter"))) == [b"ten letter"]
    with pytest.raises(RemoteProtocolError, match="a message of 11 bytes, expected at most 10"):
        list(unframer.feed(header(11)))
