"""Where is the robot? The feasible poses of Brown & Donald, rasterized."""
