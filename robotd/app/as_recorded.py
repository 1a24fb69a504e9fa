"""A recording's configuration, with settings that it lacks as things were before these settings existed.

A recording holds the effective configuration: every key that its daemon knew. So a key that is missing was not known,
and its default of today would be another behaviour than the recorded one. Each stands here with what was done then.
"""

import tomllib
from dataclasses import replace
from typing import Any

from robotd.config import Config, loads
from robotd.grid.settings import BetweenBeams
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.obstacles.thick_walls import ThickWalls
from robotd.localization.stop_poses import StopPoses

SINCE: dict[str, dict[str, Any]] = {
    "grid": {"between_beams": BetweenBeams.UNSEEN},
    "error_model": {"mapped_walls_go_on": 0.0},
    "localization": {
        "thick_walls": ThickWalls.AS_DRAWN,
        "error_radius": ErrorRadius.CONSTANT,
        "budget_s": 3600.0,
        "stops": StopPoses.ODOMETRY,
        "history": False,
    },
    "planning": {"keeps_bumps": False},
    "second_look": {"on_walls_min": 0.0, "contrast_beside_min": 0.0, "contrast_nowhere_min": 0.0},
}
"""By section and key; a section that is missing was not recorded, and says nothing."""


def recorded_config(text: str) -> Config:
    """Return the configuration that a recording was made with.

    Raises:
        ConfigError: it is not one of this version.
    """
    config = loads(text, file="the recording's configuration")
    # Read a second time, plainly: the frozen tree no longer tells which keys stood in the text and which are
    # defaults.
    written = tomllib.loads(text)
    return replace(
        config,
        error_model=replace(config.error_model, **_missing("error_model", written)),
        grid=replace(config.grid, **_missing("grid", written)),
        localization=replace(config.localization, **_missing("localization", written)),
        planning=replace(config.planning, **_missing("planning", written)),
        second_look=replace(config.second_look, **_missing("second_look", written)),
    )


def _missing(section: str, written: dict[str, Any]) -> dict[str, Any]:
    there = written.get(section)
    return {} if there is None else {key: was for key, was in SINCE[section].items() if key not in there}
