"""What an address is: data, of which the server, its guards and its description are made."""

import enum
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from aiohttp import web

from robotd.gateway.access.roles import Role
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House


class Needs(enum.Enum):
    """Who may."""

    NOBODY = "nobody"
    """Everybody, signed in or not."""
    STOP = "stop"
    """Anyone who signed in within a day."""
    TICKET = "ticket"
    """Who brings a ticket in the address, once."""
    VIEWER = "viewer"
    OPERATOR = "operator"
    ADMIN = "admin"

    @property
    def role(self) -> Role | None:
        """The role that is needed, where one is."""
        return None if self in {Needs.NOBODY, Needs.STOP, Needs.TICKET} else Role(self.value)


Answer = Callable[[web.Request, House, Person | None], Awaitable[web.StreamResponse]]


@dataclass(frozen=True, slots=True)
class Route:
    """One address: its method and path, who may ask it, what it is for, and what answers it."""

    method: str
    path: str
    needs: Needs
    summary: str
    answer: Answer
    is_socket: bool = False
