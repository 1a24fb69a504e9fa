"""The yaml beside a map image: seven keys of ROS's map_server, written exactly.

Numbers are written as the shortest text that every yaml parser reads back as the same float (map_server rounds the
resolution to three decimals; we do not). No yaml library: these files are seven lines of ``key: value``.
"""

from robotd.core.grid_spec import GridSpec
from robotd.grid.image import FREE_THRESH, OCCUPIED_THRESH


def map_yaml(image: str, spec: GridSpec) -> str:
    """Return the text of the yaml for a map whose picture is the file ``image`` beside it."""
    return (
        f"image: {image}\n"
        f"mode: trinary\n"
        f"resolution: {_written(spec.resolution_m)}\n"
        f"origin: [{_written(spec.origin_x_m)}, {_written(spec.origin_y_m)}, 0]\n"
        f"negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESH!r}\n"
        f"free_thresh: {FREE_THRESH!r}\n"
    )


def _written(value: float) -> str:
    """Return a float with a dot: YAML 1.1 takes ``1e-07`` for a text."""
    text = repr(value)
    return text if "." in text or "e" not in text else text.replace("e", ".0e")
