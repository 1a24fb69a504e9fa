"""Drive, pan/tilt and rangefinder in SI units; one small adapter per dialect."""
