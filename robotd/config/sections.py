"""Settings of the daemon as a whole; those of a room stand beside its models."""

from dataclasses import dataclass, field

from robotd.config.environment import state_dir


@dataclass(frozen=True, slots=True)
class MapsSettings:
    """Where maps are kept."""

    dir: str = field(default_factory=lambda: f"{state_dir()}/maps")
    """Directory of the stored maps."""
    keep: int = 10
    """Versions kept of each map; saving one more drops the oldest."""

    def __post_init__(self) -> None:
        """Refuse a store that keeps nothing."""
        if not self.dir:
            raise ValueError("dir must not be empty")
        if self.keep < 1:
            raise ValueError(f"keep must be at least 1, got {self.keep}")


@dataclass(frozen=True, slots=True)
class RecordingSettings:
    """Where recordings go, and from when on one can begin."""

    dir: str = field(default_factory=lambda: f"{state_dir()}/recordings")
    """Directory of the recordings for which no file is named."""
    from_start: bool = False
    """Record from the start of the daemon, always."""
    preroll_bytes: int = 16 * 1024 * 1024
    """What is remembered since the start, so that a recording begun later still begins there.

    So much of each source: the lines' bytes, requests, maps taken into use, results. None uses up what is another's.

    The three boards at 40 ms say 17 KiB/s at rest and 53 KiB/s in a mission, so 16 MiB last for a quarter of an hour or
    five minutes of missions; after that no recording can begin. Where that is too short, set ``from_start``.
    """

    def __post_init__(self) -> None:
        """Refuse a pre-roll of less than nothing."""
        if not self.dir:
            raise ValueError("dir must not be empty")
        if self.preroll_bytes < 0:
            raise ValueError(f"preroll_bytes must not be negative, got {self.preroll_bytes}")
