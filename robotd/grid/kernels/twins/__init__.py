"""The kernels in NumPy: what the ones in C must do, and what does it where they were not compiled."""

from robotd.grid.kernels.twins.counting import at_least, count_feasible, greatest
from robotd.grid.kernels.twins.distances import squared_distances
from robotd.grid.kernels.twins.drawing import draw_beams
from robotd.grid.kernels.twins.inserting import insert_rays

__all__ = ["at_least", "count_feasible", "draw_beams", "greatest", "insert_rays", "squared_distances"]
