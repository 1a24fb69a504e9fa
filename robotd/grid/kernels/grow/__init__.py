"""Cells grown by a disk."""
