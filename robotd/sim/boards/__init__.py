"""Emulated boards: the real protocol above, a plant below, no I/O and no clock."""
