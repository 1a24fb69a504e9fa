"""What the robot does: stop and sweep, map, localize, drive; and the supervisor that allows it."""
