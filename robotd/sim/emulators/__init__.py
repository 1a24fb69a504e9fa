"""Emulated vendor devices: each speaks its maker's bytes, on top of the same physics as our own boards."""
