"""What the gateway asks of the daemon, and who of the browsers may: nothing is queued or repeated but a stop."""
