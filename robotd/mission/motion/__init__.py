"""Turning, driving, standing still, one odometry message after another. It knows of no map and of no mission."""
