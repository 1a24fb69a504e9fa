"""What every request is: data, with a name on the wire and the type of its answer."""

from typing import Any, ClassVar, Generic, TypeVar

import msgspec

R = TypeVar("R")


class Request(msgspec.Struct, Generic[R], frozen=True, forbid_unknown_fields=True):
    """A request that is answered by an ``R``."""

    cmd: ClassVar[str]
    result: ClassVar[Any]
    only_looks: ClassVar[bool] = False
    """Changes nothing, so a repeated request may be carried out again."""
    is_noted: ClassVar[bool] = False
    """Acts on the robot as soon as it is carried out: the journal notes it, and a replay performs it again."""
    deadline_s: ClassVar[float] = 10.0
    """How long a client waits for the answer of a daemon that is there, repeats included: on a busy machine nothing is
    quick."""
