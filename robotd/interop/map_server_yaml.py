"""The yaml beside a map image, as ROS's map_server reads it: every key checked, none guessed."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

import yaml

from robotd.core.errors import MapError
from robotd.core.text import printable

MODES = ("trinary", "scale", "raw")
YAML_MAX_BYTES = 1 << 16


@dataclass(frozen=True, slots=True)
class MapServerYaml:
    """What the yaml says."""

    image: str
    """File name of the picture, in the folder of the yaml or below it."""
    resolution_m: float
    origin_x_m: float
    """Lower-left corner of the lower-left pixel, map frame."""
    origin_y_m: float
    yaw_rad: float
    """By how much the picture is turned about that corner, counter-clockwise."""
    occupied_thresh: float
    free_thresh: float
    negate: bool
    mode: str

    @classmethod
    def of_picture(cls, image: str, resolution_m: float | None, origin_m: tuple[float, float]) -> "MapServerYaml":
        """Describe a picture that has no yaml, by map_server's own defaults.

        Raises:
            MapError: its size is not given, or impossible.
        """
        if resolution_m is None:
            raise MapError("a picture says nothing of its size: give the yaml beside it, or its resolution_m")
        x_m, y_m = origin_m
        return _checked(cls(image, resolution_m, x_m, y_m, 0.0, 0.65, 0.196, negate=False, mode="trinary"))


def decode_map_yaml(data: bytes) -> MapServerYaml:
    """Return what a yaml says; ``mode`` is trinary where it is missing, everything else must be there.

    Raises:
        MapError: it is no yaml, too long, or a key is missing, of the wrong kind or impossible; names the key, what it
            is, and what was expected.
    """
    if len(data) > YAML_MAX_BYTES:
        raise MapError(f"it has {len(data)} bytes; the yaml of a map has a few lines, at most {YAML_MAX_BYTES} bytes")
    try:
        # Safe: YAML can name any object to be made.
        content = yaml.safe_load(data)
    except (yaml.YAMLError, UnicodeDecodeError, ValueError, RecursionError) as error:
        raise MapError(f"it is no yaml: {printable(' '.join(str(error).split()))}") from error
    if not isinstance(content, dict):
        raise MapError(f"expected keys and values (image, resolution, origin...), got {type(content).__name__}")
    origin = _value(content, "origin", "three numbers: x, y [m] and yaw [rad]", _three)
    return _checked(
        MapServerYaml(
            image=_value(content, "image", "a file name in the folder of the yaml", _file),
            resolution_m=_value(content, "resolution", "metres per pixel, a number", _number),
            origin_x_m=origin[0],
            origin_y_m=origin[1],
            yaw_rad=origin[2],
            occupied_thresh=_value(content, "occupied_thresh", "a number from 0 to 1", _number),
            free_thresh=_value(content, "free_thresh", "a number from 0 to 1", _number),
            negate=_value(content, "negate", "0 or 1", _flag),
            mode=_value({"mode": "trinary", **content}, "mode", f"one of {', '.join(MODES)}", _mode),
        )
    )


def _checked(found: MapServerYaml) -> MapServerYaml:
    if not 0.001 <= found.resolution_m <= 10.0:
        raise MapError(f"resolution: expected metres per pixel from 0.001 to 10, got {found.resolution_m:g}")
    if not 0.0 <= found.free_thresh < found.occupied_thresh <= 1.0:
        raise MapError(
            "free_thresh and occupied_thresh: expected 0 <= free_thresh < occupied_thresh <= 1,"
            f" got {found.free_thresh:g} and {found.occupied_thresh:g}"
        )
    return found


def _value(content: dict[Any, Any], key: str, expected: str, read: Callable[[Any], Any]) -> Any:
    if key not in content:
        raise MapError(f"{key} is missing; expected {expected}")
    try:
        return read(content[key])
    except (TypeError, ValueError, OverflowError) as error:
        raise MapError(f"{key}: expected {expected}, got {printable(str(content[key]))[:80]}") from error


def _number(value: Any) -> float:
    # YAML 1.1 takes 1e-3 for a text, as it has no dot; other programs write it, and read it as a number.
    # A true is a number to Python, and a slip of who wrote it.
    if isinstance(value, bool):
        raise TypeError
    number = float(value)
    if not math.isfinite(number):
        raise ValueError
    return number


def _three(value: Any) -> tuple[float, float, float]:
    if not isinstance(value, list):
        raise TypeError
    x_m, y_m, yaw_rad = map(_number, value)
    return x_m, y_m, yaw_rad


def _flag(value: Any) -> bool:
    if value not in (0, 1):  # True and False are these, too
        raise ValueError
    return bool(value)


def _mode(value: Any) -> str:
    if value not in MODES:
        raise ValueError
    return str(value)


def _file(value: Any) -> str:
    """Return a file name that does not leave the folder: a map that came by mail must not read what it likes."""
    if not isinstance(value, str) or not value or "\0" in value:
        raise TypeError
    path = PurePosixPath(value)
    if path.is_absolute() or ".." in path.parts:
        raise ValueError
    return value
