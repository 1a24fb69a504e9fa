"""Poses that cannot be excluded, counted."""
