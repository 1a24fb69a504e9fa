"""Every declared message survives the wire with any values that its fields can hold."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_proto.common import BoardKind, Hello, IdentifyReply
from firmware_proto.dictionary import REQUEST_END, TELEMETRY_END, TELEMETRY_START, answers_for, messages_for
from firmware_proto.framing import PAYLOAD_MAX, Deframer, RawFrame, encode_frame
from firmware_proto.rules import RULES
from firmware_proto.schema import REPLY, Message, Wire, payload_size, wire_fields

MESSAGES = tuple(dict.fromkeys(message for kind in BoardKind for message in messages_for(kind)))
each_message = pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.__name__)
BITS = {"B": 8, "H": 16, "I": 32, "Q": 64}


def _values(wire: Wire) -> st.SearchStrategy[Any]:
    if wire.code.endswith("s"):
        size = int(wire.code[:-1])
        return st.binary(min_size=size, max_size=size)
    bits = BITS[wire.code.upper()]
    if wire.code.islower():
        return st.integers(-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
    return st.integers(0, (1 << bits) - 1)


@each_message
@settings(max_examples=30)
@given(data=st.data(), seq=st.integers(0, 65535))
def test_round_trip(message: type[Message], data: st.DataObject, seq: int) -> None:
    sent = message(*(data.draw(_values(wire)) for wire in wire_fields(message).values()))
    (frame,) = Deframer().feed(encode_frame(RawFrame(message.TYPE, seq, sent.to_payload())))
    assert (frame.type, frame.seq) == (message.TYPE, seq)
    assert message.from_payload(frame.payload) == sent


@each_message
def test_every_message_fits_a_frame_and_every_field_is_explained(message: type[Message]) -> None:
    assert payload_size(message) <= PAYLOAD_MAX
    for name, wire in wire_fields(message).items():
        assert wire.meaning, f"{message.__name__}.{name} has no meaning"


@each_message
def test_types_lie_in_their_ranges(message: type[Message]) -> None:
    code = message.TYPE
    requests = {request.TYPE for request in RULES}
    is_request = 0 < code < REQUEST_END
    is_reply = code == REPLY or code ^ REPLY in requests
    is_telemetry = TELEMETRY_START <= code < TELEMETRY_END
    assert is_request + is_reply + is_telemetry + (code == 0xFE) == 1
    assert is_request == (message in RULES)


def test_types_are_unique() -> None:
    assert len({message.TYPE for message in MESSAGES}) == len(MESSAGES)


@pytest.mark.parametrize("kind", BoardKind)
def test_every_request_of_a_board_has_an_answer_and_a_rule(kind: BoardKind) -> None:
    requests = [message for message in messages_for(kind) if message.TYPE < REQUEST_END]
    assert {request.TYPE | REPLY for request in requests} <= answers_for(kind).keys()
    assert set(requests) <= RULES.keys()


def test_integers_are_little_endian_and_packed() -> None:
    assert Hello(1, 2, 0x01020304).to_payload() == bytes([1, 2, 4, 3, 2, 1])


def test_short_data_is_padded_with_zeros() -> None:
    assert IdentifyReply(0, b"end").to_payload() == b"\0\0end" + bytes(61)
