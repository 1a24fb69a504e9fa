"""robotd: an onboard daemon that maps a building and says where the robot is, or that it does not know.

In a program or a notebook, without a daemon: :class:`Map`, :class:`Sweep`, :class:`Pose2` (docs/library.md).
"""

import importlib
from typing import Any

__version__ = "0.2.0.dev0"

_HOMES = {"Map": "robotd.library.map", "Pose2": "robotd.core.pose", "Sweep": "robotd.core.reading"}


def __getattr__(name: str) -> Any:
    # Not imported above: whatever imports a part of robotd, a client of a few kilobytes, imports this file first.
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({"__doc__", "__name__", "__path__", "__version__", *_HOMES})
