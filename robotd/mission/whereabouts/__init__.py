"""The map in use and where the robot is on it. It moves nothing, and stops nothing."""
