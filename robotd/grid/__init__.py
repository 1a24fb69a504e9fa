"""Cells: placement, rays, look-up tables, occupancy. Arrays in, arrays out; no files, no clock, no loop."""
