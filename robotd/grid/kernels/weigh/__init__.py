"""Beams weighed on a map of chances."""
