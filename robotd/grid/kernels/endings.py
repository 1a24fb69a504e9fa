"""Where a weighed beam ends: the last axis of what :func:`~robotd.grid.kernels.weigh_beams` returns."""

AS_MAPPED = 0
"""At an obstacle of the map; a miss: nowhere before its range."""
IN_UNKNOWN = 1
"""Where nobody has looked."""
IN_VACANT = 2
"""In a cell that is vacant on the map."""
