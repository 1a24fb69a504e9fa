"""What every room shares: poses, angles, readings, the clock, errors and the log."""
