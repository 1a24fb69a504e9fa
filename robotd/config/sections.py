"""Settings of the daemon as a whole; those of a room stand beside its models."""

from dataclasses import dataclass, field
from typing import Annotated

from robotd.config.environment import state_dir
from robotd.core.bounds import Within, refuse_outside
from robotd.maps.manifest import is_name

LAST = "last"
"""In place of the name of a map: the one that somebody saved last."""


@dataclass(frozen=True, slots=True)
class MapsSettings:
    """Where maps are kept, and which one is in use from the start."""

    dir: str = field(default_factory=lambda: f"{state_dir()}/maps")
    """Directory of the stored maps."""
    keep: Annotated[int, Within(1, 100_000)] = 10
    """Versions kept of each map; saving one more drops the oldest."""
    load: str = ""
    """Map to take into use when the daemon starts, its name or ``last``; none if it is empty."""

    def __post_init__(self) -> None:
        """Refuse a store that keeps nothing."""
        if not self.dir:
            raise ValueError("dir must not be empty")
        if self.load and not is_name(self.load):
            raise ValueError(f"load must be the name of a map, or last, got {self.load!r}")
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class RecordingSettings:
    """Where recordings go, and from when on one can begin."""

    dir: str = field(default_factory=lambda: f"{state_dir()}/recordings")
    """Directory of the recordings; none is made elsewhere."""
    from_start: bool = False
    """Record from the start of the daemon, always."""
    preroll_bytes: Annotated[int, Within(0, 2**32, "bytes")] = 16 * 1024 * 1024
    """What is remembered since the start, so that a recording begun later still begins there.

    This much of each source: the lines' bytes, requests, maps taken into use, results. None uses up what is another's.

    The three boards at 40 ms say 17 KiB/s at rest and 53 KiB/s in a mission, so 16 MiB last for a quarter of an hour or
    five minutes of missions; after that no recording can begin. Where that is too short, set ``from_start``.
    """

    def __post_init__(self) -> None:
        """Refuse a pre-roll of less than nothing."""
        if not self.dir:
            raise ValueError("dir must not be empty")
        refuse_outside(self)
