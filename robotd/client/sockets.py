"""How a client's sockets are set up and connected."""

import secrets
from typing import Any

import zmq

from robotd.contract.topics import Topic
from robotd.core.endpoints import Endpoints


def connect_dealer(socket: "zmq.Socket[Any]", endpoints: Endpoints, *, retry_s: float) -> None:
    """Connect a DEALER to the commands.

    It keeps one identity over reconnections, so that a repeated request is recognized, and it queues nothing while
    there is no daemon: an old request must not reach a new daemon.
    """
    socket.setsockopt(zmq.IDENTITY, secrets.token_bytes(16))
    socket.setsockopt(zmq.IMMEDIATE, 1)
    # With IMMEDIATE a send waits for a connection: no longer than until its repeat is due.
    socket.setsockopt(zmq.SNDTIMEO, max(1, int(retry_s * 1000)))
    socket.setsockopt(zmq.LINGER, 0)  # a program that ends must not wait for a daemon that is gone
    socket.connect(endpoints.commands)


def connect_subscriber(socket: "zmq.Socket[Any]", endpoints: Endpoints, topics: tuple[Topic, ...]) -> None:
    """Connect a SUB to the topics; maps come over a socket of their own."""
    socket.setsockopt(zmq.LINGER, 0)
    for topic in topics:
        socket.subscribe(topic.prefix)
    for endpoint in {endpoints.maps if topic is Topic.MAP else endpoints.state for topic in topics}:
        socket.connect(endpoint)
