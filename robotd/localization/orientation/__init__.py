"""The heading from the walls: separated orientation ([BrownDonald2000]_ sec. 2.2.3)."""
