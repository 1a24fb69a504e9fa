"""How far the nearest wall is, and how far a beam may be sure to go: two codes of a byte a cell.

Distances are kept as one signed byte a cell: the square of the distance between cell centres, which is a whole number.
Cells that are no wall hold the square to the nearest wall, up to ``REACH_CELLS`` of it, walls the square to the nearest
cell that is none, negative, up to ``DEPTH_CELLS``. A table of 256 entries turns a byte into a distance, and so says
where in its cells a wall lies, without the field being made anew. Both are exact, and as no cell knows of anything
farther away, what changes in a window changes the field no farther round it.
"""

REACH_CELLS = 8
"""Farther than this from a wall all is equally far."""
FAR_CODE = REACH_CELLS * REACH_CELLS
DEPTH_CELLS = 4
"""Deeper than this in a wall all is equally deep."""
SKIP_MAX = 15
"""No beam skips more cells than this at once."""
ENDS, BLOCKS = 0, 255
"""Skips of a cell that ends a beam as a wall does, and of one that stops it as nobody knows what is there."""
