"""Where to look next: what may be seen from where the robot can go, and what that is worth."""
