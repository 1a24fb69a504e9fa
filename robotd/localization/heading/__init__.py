"""The heading before the position: separated orientation."""
