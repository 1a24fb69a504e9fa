"""Feasible poses, rank and loc, exactly.

[BrownDonald2000]_ sec. 2.2.2: FP(M, z) and FP_eps(M, z) (theorems 3 and 4), FP(M, Z) and loc(M, Z) of many readings
(theorems 5 and 7, corollaries 6 and 8). First each reading by a sweep of its own over D and the parts of E; then one
sweep over what is left of each, whose masks say at every vertex, on every edge and in every face which readings hold
there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from robotd.exact.arrangement import Arrangement, Mask, at_least
from robotd.exact.beams import Beam
from robotd.exact.minkowski import blocked, grown
from robotd.exact.planar import PlanarSet
from robotd.exact.rationals import Rational
from robotd.exact.sweep import arrange


@dataclass(frozen=True)  # no slots: a cached property needs a place to be kept
class PolygonMap:
    """A map for one error radius; what many readings need of it is made once."""

    obstacles: PlanarSet
    """M, closed, as :func:`robotd.exact.polygons.solid` makes it."""
    eps: Rational
    """By how much a range may be wrong; 0 for the paper's exact case."""

    def __post_init__(self) -> None:
        """Refuse a negative error."""
        if self.eps < 0:
            raise ValueError(f"eps must not be negative, got {self.eps}")

    @cached_property
    def grown(self) -> PlanarSet:
        """M (+) B_eps."""
        return grown(self.obstacles, self.eps)

    def endpoint_set(self, beam: Beam) -> PlanarSet:
        """Return D_eps(M, z), closed: the poses from which the beam ends within eps of the map."""
        return self.grown.moved(-beam.dx, -beam.dy)

    def blocked_parts(self, beam: Beam) -> list[PlanarSet]:
        """Return parts of which the union is E_eps(M, z): the poses from which the beam's body is in the way of M."""
        return blocked(self.obstacles, (beam.dx, beam.dy), beam.body_share(self.eps))


def feasible_arrangement(polygon_map: PolygonMap, beam: Beam) -> Arrangement:
    """Return the arrangement of D (bit 0; everything, for an over-range reading) and the parts of E (the others).

    O((n + s) log n) for n edges of the map, where the borders of D and of the parts meet in s points (theorems 3, 4).
    """
    everywhere = PlanarSet(far=True)
    return arrange([polygon_map.endpoint_set(beam) if beam.is_hit else everywhere, *polygon_map.blocked_parts(beam)])


def is_feasible(mask: Mask) -> bool:
    """Return whether a cell of such an arrangement is covered by D and by no part of E: (k, 0) of the paper."""
    return mask == 1


def feasible_poses(polygon_map: PolygonMap, beam: Beam) -> PlanarSet:
    """Return FP_eps(M, z): areas, segments and single points. For an over-range reading, all poses not in E."""
    return feasible_arrangement(polygon_map, beam).select(is_feasible)


def ranked(polygon_map: PolygonMap, beams: Sequence[Beam]) -> Arrangement:
    """Return the arrangement of the feasible poses of many readings.

    Bit k of a mask is the k-th reading; how many bits are set is the rank of the cell, rnk(M, Z, p). For m readings
    O((m n^2 + s) log m n) at worst (theorems 5, 7): the feasible poses of one have up to n^2 borders.
    """
    # Each reading's own set first: D and all parts of E of all readings at once would cross in far more points.
    return arrange([feasible_poses(polygon_map, beam) for beam in beams])


def best_rank(arrangement: Arrangement) -> int:
    """Return kappa, the greatest rank of all cells."""
    return max(mask.bit_count() for mask in arrangement.masks)


def of_rank(arrangement: Arrangement, least: int) -> PlanarSet:
    """Return the poses that explain at least this many readings: loc(M, Z) for the best rank, FP(M, Z) for all."""
    return arrangement.select(at_least(least))
