"""What somebody may do, as three steps; each may do all that the ones before may."""

import enum
from typing import Any

from robotd.contract.request import Request

_OF_ADMINS = {"map_delete", "record_delete"}
"""What cannot be taken back."""


class Role(enum.StrEnum):
    """A step of the ladder."""

    VIEWER = "viewer"
    OPERATOR = "operator"
    ADMIN = "admin"

    def may(self, needed: "Role") -> bool:
        """Return whether this role is enough where ``needed`` is asked for.

        >>> Role.ADMIN.may(Role.OPERATOR), Role.VIEWER.may(Role.OPERATOR)
        (True, False)
        """
        ladder = list(Role)
        return ladder.index(self) >= ladder.index(needed)


def role_for(command: type[Request[Any]]) -> Role:
    """Return who may send a command: looking is for all who signed in, and a stop is asked of no role at all."""
    # By what the contract says of each command: one that is new has its role without a list to keep.
    if command.only_looks:
        return Role.VIEWER
    return Role.ADMIN if command.cmd in _OF_ADMINS else Role.OPERATOR
