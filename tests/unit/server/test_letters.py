"""Whose turn it is: nobody twice while somebody else waits, and stops and renewals every second time."""

from dataclasses import dataclass, field
from typing import Any, cast

import pytest

from robotd.contract.envelope import encode_request
from robotd.contract.request import Request
from robotd.contract.requests import Disarm, GetStatus, Renew, Stop
from robotd.server.client_connection import Connection
from robotd.server.letters import Letters


@dataclass(eq=False)
class Client:
    """A connection, as far as letters know it."""

    identity: bytes
    process: str = "a test"
    wanted: list[bool] = field(default_factory=list)

    def listen(self, *, to_it: bool) -> None:
        self.wanted.append(to_it)

    @property
    def connection(self) -> Connection:
        return cast("Connection", self)


def crowd(letters: Letters, count: int, request: Request[Any]) -> list[Client]:
    clients = [Client(b"client %d" % number) for number in range(count)]
    for client in clients:
        letters.joined(client.connection)
        letters.heard(client.connection, (encode_request(1, request),))
    return clients


@pytest.mark.parametrize(
    "said",
    [
        encode_request(7, Stop("enough")),
        encode_request(7, Disarm()),
        encode_request(7, Renew(3)),
        b'{"cmd": "STOP"}',
        b"stop",
    ],
)
async def test_a_stop_or_a_renewal_waits_for_none_of_those_who_ask_for_something_else(said: bytes) -> None:
    letters, last = Letters(), Client(b"last")
    crowd(letters, 200, GetStatus())
    letters.joined(last.connection)
    letters.heard(last.connection, (said,))
    assert (await letters.receive()).identity == b"last"
    assert last.wanted == [False, True]
    assert {(await letters.receive()).identity for _ in range(200)} == {b"client %d" % number for number in range(200)}


async def test_who_floods_with_stops_keeps_nobody_else_from_a_turn() -> None:
    letters, last = Letters(), Client(b"last")
    flooding = {client.identity: client for client in crowd(letters, 10, Stop())}
    letters.joined(last.connection)
    letters.heard(last.connection, (encode_request(1, GetStatus()),))
    turns = 1
    while (taken := (await letters.receive()).identity) != b"last":
        letters.heard(flooding[taken].connection, (encode_request(1, Stop()),))
        turns += 1
    assert turns <= 2 * (len(flooding) + 1)


async def test_a_client_that_left_has_no_turn_any_more_but_what_it_asked_has() -> None:
    letters = Letters()
    (client,) = crowd(letters, 1, Stop())
    letters.left(client.connection)
    assert (await letters.receive()).identity == b"client 0"
    crowd(letters, 1, GetStatus())
    assert (await letters.receive()).identity == b"client 0"
