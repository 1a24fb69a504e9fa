"""What the daemon tells: one subscription, what is known by now, and what waits for each browser."""
