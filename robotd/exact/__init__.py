"""The exact combinatorial algorithm: feasible poses in maps of polygons, by plane sweep.

[BrownDonald2000]_ sec. 2.2.2 and appendix. Nothing is rounded: coordinates are rationals and square roots of them, and
every decision is exact. It is the truth that the rasterized algorithm is held against, and runs offline.

From the ground up: ``rationals`` (the arithmetic is the caller's choice) and ``surds`` (numbers), ``points``,
``supports`` (lines, circles), ``planar`` (point sets by their borders), ``sweep`` (their ``arrangement``), ``polygons``
(maps), ``minkowski`` (D and E), ``feasible`` (FP, rank, loc), ``casting`` (the definition, point by point).
"""
