"""Dialects, sans-I/O: bytes to messages and back; no loop, no clock, no log."""
