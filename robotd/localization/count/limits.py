"""What one stop may keep, and what it may tell."""

FEW_HEADINGS = 32
"""This many are counted as the readings come: 256 x 256 cells then take 10 MB."""
POSES_TOLD_MAX = 1 << 16
"""More poses than this are no answer. A place has some hundred; of scans of 240 m of corridor, where doors look
like doors, the most had 38 000."""
