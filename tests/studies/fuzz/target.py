"""What is fuzzed: bytes in, and nothing may come out but an answer or a typed error."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

ROOT = Path(__file__).parents[3]
KIB = 1024
MIB = 1024 * KIB
_STREAM_MAX = 160
"""A few messages: more would only be slower."""


class Feedable(Protocol):
    """A parser of a stream."""

    def feed(self, data: bytes) -> Iterable[object]:
        """Take bytes as they come; return the messages that are whole now."""


@dataclass(frozen=True, slots=True)
class Target:
    """One parser."""

    name: str
    run: Callable[[bytes], object]
    """Parses, and asserts whatever must hold."""
    seeds: Callable[[], list[bytes]]
    """What it understands, to begin with."""
    traced: tuple[str, ...]
    """The sources whose lines count as found, as paths below the project; a folder means all in it."""
    typed: tuple[type[Exception], ...] = ()
    """The errors that it may raise."""
    tokens: tuple[bytes, ...] = ()
    """Words of its language, which chance would not find."""
    size_max: int = 1024
    """Inputs are not longer."""
    peak_max: int = 2 * MIB
    """This much memory may one input take."""
    executions: int = 150
    """How often it is run in the tests."""
    measured: int = 60
    """For how many inputs its memory is measured."""
    outlined: bool = False
    """Whether only inputs are watched of which another thing is said than of all before, numbers left out: to watch
    takes several times as long as to run."""
    proves: Callable[[bytes], None] | None = None
    """Asserts what must hold besides, without being watched, which takes time."""
    stream: Callable[[], Feedable] | None = None
    """Makes the parser of a stream: a flood is fed to one in pieces, and it may keep little of it."""
    files: frozenset[str] = field(init=False)

    def __post_init__(self) -> None:
        """Find the sources."""
        found: set[str] = set()
        for name in self.traced:
            path = ROOT / name
            found |= {str(one) for one in (path.rglob("*.py") if path.is_dir() else [path])}
            assert path.exists(), path
        object.__setattr__(self, "files", frozenset(found))


def of_stream(
    name: str,
    make: Callable[[], Feedable],
    seeds: Callable[[], list[bytes]],
    traced: str,
    *,
    tokens: tuple[bytes, ...] = (),
) -> Target:
    """Return the target of a parser of a stream: it raises nothing, and pieces make no difference."""

    def run(data: bytes) -> object:
        return list(make().feed(data))

    def proves(data: bytes) -> None:
        pieces = make()
        assert run(data) == [one for at in range(len(data)) for one in pieces.feed(data[at : at + 1])]

    return Target(name, run, seeds, (traced,), tokens=tokens, proves=proves, stream=make, size_max=_STREAM_MAX)
