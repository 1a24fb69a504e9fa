"""Composition root: configuration to objects to one task group; start and stop order; no logic."""
