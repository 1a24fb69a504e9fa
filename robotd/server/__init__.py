"""Commands and state over ZeroMQ, and the client for both."""
