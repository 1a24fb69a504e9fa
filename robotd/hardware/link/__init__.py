"""A conversation over a transport: requests, retries, clock, reconnecting, and the tap."""
