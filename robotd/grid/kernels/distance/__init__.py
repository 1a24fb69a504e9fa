"""The distance to the nearest source."""
