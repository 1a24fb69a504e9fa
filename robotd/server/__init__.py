"""Commands and state over ZeroMQ, and nothing of the engine."""
