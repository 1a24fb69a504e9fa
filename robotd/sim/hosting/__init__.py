"""Boards on the loop's clock, their own clocks, and the lines they are on."""
