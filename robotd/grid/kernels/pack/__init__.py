"""Cells packed into words."""
