"""Bytes only: serial port, pseudo-terminal, TCP, memory."""
