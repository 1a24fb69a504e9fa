"""The yaml beside a map image: seven keys of ROS's map_server, written exactly and read strictly.

Numbers are written as the shortest text that reads back to the same float (map_server rounds the resolution to
three decimals; we do not). The reader takes what map_server and its kin write for a two-dimensional trinary map, and
refuses everything that it would have to ignore. No yaml library: these files are seven lines of ``key: value``.
"""

import math
import re
from dataclasses import dataclass

from robotd.core.errors import MapError
from robotd.grid.image import FREE_THRESH, OCCUPIED_THRESH

_LINE = re.compile(r"([a-z_]+)\s*:\s*(.*)")
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_TRUE_OR_FALSE = {"0": False, "1": True, "false": False, "true": True}


@dataclass(frozen=True, slots=True)
class MapYaml:
    """What a map's yaml says."""

    image: str
    """Name of the image, relative to the yaml."""
    resolution_m: float
    """Side of one pixel."""
    origin_x_m: float
    """Lower-left corner of the lower-left pixel, map frame."""
    origin_y_m: float
    negate: bool = False
    """Whether white means occupied."""
    occupied_thresh: float = OCCUPIED_THRESH
    free_thresh: float = FREE_THRESH

    def text(self) -> str:
        """Return the file's text."""
        return (
            f"image: {self.image}\n"
            f"mode: trinary\n"
            f"resolution: {self.resolution_m!r}\n"
            f"origin: [{self.origin_x_m!r}, {self.origin_y_m!r}, 0]\n"
            f"negate: {int(self.negate)}\n"
            f"occupied_thresh: {self.occupied_thresh!r}\n"
            f"free_thresh: {self.free_thresh!r}\n"
        )


def read_map_yaml(text: str) -> MapYaml:
    """Return what a map's yaml says.

    Raises:
        MapError: a key is missing, unknown or twice there, a value is impossible, or the map is of a kind that is
            not supported (rotated, or not trinary).
    """
    values = _key_values(text)
    missing = [key for key in _REQUIRED if key not in values]
    if missing:
        raise MapError(f"the map's yaml has no {', '.join(missing)}")
    if values.get("mode", "trinary") != "trinary":
        raise MapError(f"the map's mode is {values['mode']}, only trinary is supported")
    resolution_m = _number("resolution", values["resolution"])
    if resolution_m <= 0.0:
        raise MapError(f"the map's resolution must be positive, got {resolution_m}")
    origin_x_m, origin_y_m = _origin(values["origin"])
    occupied_thresh, free_thresh = (_number(key, values[key]) for key in ("occupied_thresh", "free_thresh"))
    if not 0.0 <= free_thresh < occupied_thresh <= 1.0:
        raise MapError(f"the map's thresholds must be 0 <= free < occupied <= 1, got {free_thresh}, {occupied_thresh}")
    image = values["image"].strip("\"'")
    if not image:
        raise MapError("the map's yaml names no image")
    return MapYaml(
        image, resolution_m, origin_x_m, origin_y_m, _truth("negate", values["negate"]), occupied_thresh, free_thresh
    )


def _key_values(text: str) -> dict[str, str]:
    values: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        content = line.split(" #")[0].strip()
        if not content or content.startswith(("#", "---")):
            continue
        match = _LINE.fullmatch(content)
        if match is None:
            raise MapError(f"line {number} of the map's yaml is not 'key: value': {line!r}")
        key, value = match.groups()
        if key not in (*_REQUIRED, "mode"):
            raise MapError(f"line {number} of the map's yaml has the unknown key {key!r}")
        if key in values:
            raise MapError(f"line {number} of the map's yaml gives {key!r} a second time")
        values[key] = value
    return values


def _number(key: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise MapError(f"the map's {key} is not a number: {text!r}")
    return number


def _origin(text: str) -> tuple[float, float]:
    parts = text.removeprefix("[").removesuffix("]").split(",")
    if not (text.startswith("[") and text.endswith("]") and len(parts) == 3):
        raise MapError(f"the map's origin is not [x, y, yaw]: {text!r}")
    x_m, y_m, yaw_rad = (_number("origin", part) for part in parts)
    if yaw_rad != 0.0:
        raise MapError(f"the map is rotated by {yaw_rad} rad, which is not supported")
    return x_m, y_m


def _truth(key: str, text: str) -> bool:
    if text.lower() not in _TRUE_OR_FALSE:
        raise MapError(f"the map's {key} is neither 0 nor 1: {text!r}")
    return _TRUE_OR_FALSE[text.lower()]
