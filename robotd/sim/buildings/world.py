"""A room to drive in: walls, where the robot starts, and good places to stop."""

import difflib
import math
import re
import tomllib
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec

from robotd.core.errors import ConfigError
from robotd.core.pose import Pose2
from robotd.sim.physics.walls import Plate, Point, WallSegments

WORLDS_DIR = Path(__file__).parent / "worlds"


@dataclass(frozen=True, slots=True)
class Wall:
    """One polygon or polyline."""

    points_m: tuple[Point, ...]
    """Its corners, world frame."""
    closed: bool = True
    """Whether the last corner is joined to the first."""
    height_m: float = math.inf
    """How high it reaches above the floor; to the ceiling if not given."""
    from_m: float = 0.0
    """Where it begins above the floor: a table's top stands on air."""
    name: str = ""
    """For people."""

    def __post_init__(self) -> None:
        """Refuse a wall that is none."""
        if len(self.points_m) < 2:
            raise ValueError(f"points_m must name at least 2 corners, got {len(self.points_m)}")
        if not all(math.isfinite(value) for point in self.points_m for value in point):
            raise ValueError("points_m must be finite")
        if not self.height_m > 0.0:
            raise ValueError(f"height_m must be positive, got {self.height_m}")
        if not 0.0 <= self.from_m < self.height_m:
            raise ValueError(f"from_m must lie in [0, height_m), got {self.from_m}")

    def segments(self) -> tuple[tuple[Point, Point, float, float], ...]:
        """Return its ``(start, end, height, where it begins)``."""
        ends = self.points_m[1:] + (self.points_m[:1] if self._is_solid else ())
        return tuple((start, end, self.height_m, self.from_m) for start, end in zip(self.points_m, ends, strict=False))

    def plates(self) -> tuple[Plate, ...]:
        """Return its faces that lie level: the top, unless it is out of sight, and the bottom, unless it stands."""
        heights_m = [height_m for height_m in (self.from_m, self.height_m) if 0.0 < height_m < math.inf]
        return tuple(Plate(self.points_m, height_m) for height_m in heights_m) if self._is_solid else ()

    @property
    def _is_solid(self) -> bool:
        return self.closed and len(self.points_m) > 2


@dataclass(frozen=True, slots=True)
class Start:
    """Where the robot stands at first, world frame."""

    x_m: float
    y_m: float
    heading_deg: float = 0.0


@dataclass(frozen=True)
class World:
    """A room, as its file describes it."""

    name: str
    start: Start
    wall: tuple[Wall, ...]
    stops_m: tuple[Point, ...] = ()
    """A tour from which the whole room is seen; the start comes first and is not repeated here."""
    probes_m: tuple[Point, ...] = ()
    """Other places, to localize at."""

    def __post_init__(self) -> None:
        """Refuse a room without walls."""
        if not self.wall:
            raise ValueError("wall: a world needs at least one")

    @cached_property
    def walls(self) -> WallSegments:
        """All its walls as segments."""
        plates = (plate for wall in self.wall for plate in wall.plates())
        return WallSegments.of((segment for wall in self.wall for segment in wall.segments()), *plates)

    @property
    def start_pose(self) -> Pose2:
        """Where the robot stands at first."""
        return Pose2(self.start.x_m, self.start.y_m, math.radians(self.start.heading_deg))


def world_names() -> tuple[str, ...]:
    """Return the names of the worlds that come with robotd."""
    return tuple(sorted(path.stem for path in WORLDS_DIR.glob("*.toml")))


def load_world(name_or_path: str) -> World:
    """Return one of :func:`world_names`, or the world of a file.

    Raises:
        ConfigError: there is no such world, or the file is not one; says where and why.
    """
    path = WORLDS_DIR / f"{name_or_path}.toml" if name_or_path in world_names() else Path(name_or_path)
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors begin with a byte order mark
    except FileNotFoundError as error:
        known = ", ".join(world_names())
        raise ConfigError(f"no such world; known: {known}, or a path", file=name_or_path) from error
    except OSError as error:
        raise ConfigError(error.strerror or str(error), file=name_or_path) from error
    except UnicodeDecodeError as error:
        raise ConfigError(
            f"not UTF-8: byte {error.start} is {error.object[error.start]:#04x}", file=name_or_path
        ) from error
    return parse_world(text, file=str(path))


def parse_world(text: str, *, file: str) -> World:
    """Return the world described by a TOML text.

    Raises:
        ConfigError: with ``file``, line and key, and the nearest name for an unknown key.
    """
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        raise ConfigError(str(error), file=file, line=int(line[1]) if line else None) from error
    # tomllib calls itself for each bracket, and a file may have any number.
    except RecursionError:
        raise ConfigError("brackets within brackets without end", file=file) from None
    _refuse_unknown_keys(table, text, file)
    try:
        return msgspec.convert(table, World)
    except msgspec.ValidationError as error:
        message, _, place = str(error).partition(" - at ")
        path = _path_of(place)
        raise ConfigError(message, file=file, line=_line_of(text, path), key=".".join(path)) from error


def _refuse_unknown_keys(table: dict[str, Any], text: str, file: str) -> None:
    # msgspec could refuse them, but knows neither the line nor the name that was meant.
    found: list[tuple[str, type]] = [(key, World) for key in table]
    found += [(f"start.{key}", Start) for key in _keys(table.get("start"))]
    walls = table.get("wall")
    for index, wall in enumerate(walls if isinstance(walls, list) else ()):
        found += [(f"wall[{index}].{key}", Wall) for key in _keys(wall)]
    for path, kind in found:
        key = path.rpartition(".")[2]
        known = [field.name for field in fields(kind)]
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            hint = f"; did you mean {near[0]}?" if near else f"; known: {', '.join(known)}"
            raise ConfigError(f"unknown key{hint}", file=file, line=_line_of(text, tuple(path.split("."))), key=path)


def _keys(table: object) -> tuple[str, ...]:
    return tuple(table) if isinstance(table, dict) else ()


def _path_of(place: str) -> tuple[str, ...]:
    """Return the keys of ``$.wall[2].points_m[0]`` as msgspec writes it, between back-ticks."""
    return tuple(part for part in place.strip("`$.").split(".") if part)


def _line_of(text: str, path: tuple[str, ...]) -> int | None:
    """Return the line of a key, or of the nearest table around it that begins a line."""
    lines = text.splitlines()
    found: int | None = None
    for part in path:
        name, _, index = part.rstrip("]").partition("[")
        header = re.compile(rf"\s*(\[+\s*)?{re.escape(name)}\s*(=|\])")
        matches = [number for number in range(found or 0, len(lines)) if header.match(lines[number])]
        if not matches:
            break
        found = matches[int(index)] if index.isdigit() and len(matches) > int(index) else matches[0]
    return None if found is None else found + 1
