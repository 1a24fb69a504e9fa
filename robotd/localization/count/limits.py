"""What one stop may keep, and what it may tell."""

FEW_HEADINGS = 32
"""This many are counted as the readings come: 256 x 256 cells then take 10 MB."""
POSES_TOLD_MAX = 1 << 15
"""More poses than this are no answer; a place that is one has some hundred."""
