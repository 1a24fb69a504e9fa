"""What the robot does: map, localize, drive; each a row, and one of them under way at a time."""
