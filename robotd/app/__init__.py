"""Composition root: configuration to objects to one task group; start and stop order; no logic."""

from robotd.app.daemon import main, program

__all__ = ["main", "program"]
