"""Composition root: configuration to objects to one task group; start and stop order; no logic."""

from robotd.app.daemon import main
from robotd.app.replaying import ReplayReport, replay_recording

__all__ = ["ReplayReport", "main", "replay_recording"]
