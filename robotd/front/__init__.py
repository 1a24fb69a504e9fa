"""The process that serves clients, and what the daemon's heart says to it: the two meet in messages alone."""
