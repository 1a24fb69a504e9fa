"""Readings drawn on the grid: what shares a chain of cells is together."""
