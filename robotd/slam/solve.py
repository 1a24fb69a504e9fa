"""Poses that bend the edges least: Gauss-Newton on SE(2), with weights that take the say from what is wrong.

Squares alone would let one false loop bend a whole map. So robust edges lose their weight as they are bent: at first
gently (Cauchy), from which all starts lead downhill, then for good (dynamic covariance scaling), where what is left of
an edge is so little that it counts as refused.
"""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import TooLarge
from robotd.slam.blocks import Factor, Structure, factored
from robotd.slam.graph import Edge, EdgeTable, chi2, linear, residuals
from robotd.slam.stop_graph import StopGraph
from robotd.slam.stops import Poses

_Weigh = Callable[[NDArray[np.float64]], NDArray[np.float64]]
STOPS_MAX = 20_000
_CAUCHY = 25.0
"""An edge bent by this chi2 has half its say, at first."""
_SCALING = 10.0
"""An edge bent by more than this chi2 loses its say, in the end."""
_REFUSED = 0.1
"""An edge of less weight is refused."""
_STEPS_MAX = 20
_STILL = 1e-7
"""Metres and radians: where no pose moves by more, it is solved."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The poses that bend the edges least."""

    poses: Poses
    weights: NDArray[np.float64]
    """``float64[m]``: what say each edge had in the end, 0 to 1."""
    refused: tuple[int, ...]
    """Which edges contradict all others, as indices."""
    system: "System"
    """The normal equations at the solution."""

    def relative_covariance(self, one: int, others: Sequence[int]) -> NDArray[np.float64]:
        """Return how sure the place of one stop is relative to others, ``float64[k, 3, 3]``, along the map's axes."""
        return self.system.relative_covariance(one, others)


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """Normal equations, factored, of all poses that are not fixed."""

    factor: Factor
    unknown_of: NDArray[np.intp]
    """``intp[n]``: which unknown each stop is, -1 if it is fixed."""

    def relative_covariance(self, one: int, others: Sequence[int]) -> NDArray[np.float64]:
        """Return the covariances of differences of poses, ``float64[k, 3, 3]``. O(k x blocks of the factor)."""
        wanted = [one, *others]
        unknowns = self.unknown_of[wanted]
        right = np.zeros((self.factor.structure.unknowns, 3, 3 * len(wanted)))
        for at, unknown in enumerate(unknowns.tolist()):
            if unknown >= 0:
                right[unknown, :, 3 * at : 3 * at + 3] = np.eye(3)
        solved = self.factor.solved(right)
        # A fixed stop is sure, and so is how it varies with any other.
        rows = np.where((unknowns >= 0)[:, None, None], solved[unknowns], 0.0)
        cross = rows.reshape(len(wanted), 3, len(wanted), 3).transpose(0, 2, 1, 3)
        own = cross[range(len(wanted)), range(len(wanted))]
        relative: NDArray[np.float64] = own[:1] + own[1:] - cross[0, 1:] - cross[1:, 0]
        return relative


def solve(poses: Poses, edges: Sequence[Edge], fixed: Sequence[int] = (0,)) -> Solution:
    """Return the poses that bend the edges least.

    Args:
        poses: where to begin.
        edges: which hold all stops together.
        fixed: stops that stay where they are.

    Raises:
        TooLarge: there are too many stops.
        ValueError: some stops hang on no fixed one.

    O(steps x (edges + blocks of the factor)).
    """
    if len(poses) > STOPS_MAX:
        raise TooLarge(f"{len(poses)} stops are too many for one graph; at most {STOPS_MAX}")
    problem = _Problem.of(len(poses), edges, fixed)
    # Two passes: what Cauchy has brought near to the truth, scaling may cut off.
    poses, _ = problem.settled(poses, _cauchy)
    poses, factor = problem.settled(poses, _scaled)
    # Weighed at the poses as they are in the end: a step before, an edge may have looked better than it is.
    bent = chi2(residuals(problem.table, poses), problem.table)
    weights = np.where(problem.table.robust, _scaled(bent), 1.0)
    refused = tuple(np.flatnonzero(weights < _REFUSED).tolist())
    return Solution(poses, weights, refused, System(factor, problem.unknown_of))


def system_at(graph: StopGraph, fixed: Sequence[int] = (0,)) -> System:
    """Return the normal equations at poses as they are: how sure places are relative to each other."""
    problem = _Problem.of(len(graph.poses), graph.edges, fixed)
    factor, _ = problem.equations(graph.poses, _scaled)
    return System(factor, problem.unknown_of)


def _cauchy(bent: NDArray[np.float64]) -> NDArray[np.float64]:
    return 1.0 / (1.0 + bent / _CAUCHY)


def _scaled(bent: NDArray[np.float64]) -> NDArray[np.float64]:
    weights: NDArray[np.float64] = np.minimum(1.0, 2.0 * _SCALING / (_SCALING + bent)) ** 2
    return weights


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """What stays the same from step to step."""

    table: EdgeTable
    unknown_of: NDArray[np.intp]
    structure: Structure
    between: NDArray[np.intp]
    """Edges between two unknowns."""
    places: NDArray[np.intp]
    """Where the block of each of those lies."""
    is_turned: NDArray[np.bool_]
    """Whether its row is the earlier stop."""

    @classmethod
    def of(cls, stops: int, edges: Sequence[Edge], fixed: Sequence[int]) -> "_Problem":
        table = EdgeTable.of(edges)
        is_free = np.ones(stops, np.bool_)
        is_free[list(fixed)] = False
        unknown_of = np.where(is_free, np.cumsum(is_free) - 1, -1)
        unknowns = unknown_of[table.ends]
        between = np.flatnonzero((unknowns >= 0).all(axis=1))
        pairs = unknowns[between]
        structure = _structure(int(is_free.sum()), tuple(sorted({(min(p), max(p)) for p in pairs.tolist()})))
        places, turned = [], []
        for earlier, later in pairs.tolist():
            is_turned = (later, earlier) not in structure.places
            turned.append(is_turned)
            # Only one of the two triangles is kept, so the block of a pair may be the transpose of what is
            # stored.
            places.append(structure.places[(earlier, later) if is_turned else (later, earlier)])
        return cls(table, unknown_of, structure, between, np.array(places, np.intp), np.array(turned, np.bool_))

    def settled(self, poses: Poses, weigh: _Weigh) -> tuple[Poses, Factor]:
        """Return the poses after as many steps as it takes, and the equations of the last step."""
        # Bounded, for a sweep waits for it; each of the steps so far is an improvement all the same.
        for _ in range(_STEPS_MAX):
            factor, right = self.equations(poses, weigh)
            moves = np.zeros((len(poses), 3))
            moves[self.unknown_of >= 0] = factor.solved(right[:, :, None])[:, :, 0]
            poses = poses + moves
            if np.abs(moves).max(initial=0.0) < _STILL:
                break
        return poses, factor

    def equations(self, poses: Poses, weigh: _Weigh) -> tuple[Factor, NDArray[np.float64]]:
        at, table = linear(self.table, poses), self.table
        weights = np.where(table.robust, weigh(chi2(at.residuals, table)), 1.0)
        information = table.information * weights[:, None, None]
        ends = self.unknown_of[table.ends]
        diagonal = np.zeros((self.structure.unknowns, 3, 3))
        right = np.zeros((self.structure.unknowns, 3))
        for end, by in ((0, at.by_earlier), (1, at.by_later)):
            free = ends[:, end] >= 0
            weighted = by[free].transpose(0, 2, 1) @ information[free]
            # Added one after the other: many edges end at one stop, and plain indexing would keep the last.
            np.add.at(diagonal, ends[free, end], weighted @ by[free])
            np.subtract.at(right, ends[free, end], (weighted @ at.residuals[free, :, None])[:, :, 0])
        below = np.zeros((self.structure.below, 3, 3))
        some = self.between
        cross = at.by_later[some].transpose(0, 2, 1) @ information[some] @ at.by_earlier[some]
        np.add.at(below, self.places, np.where(self.is_turned[:, None, None], cross.transpose(0, 2, 1), cross))
        try:
            return factored(self.structure, diagonal, below), right
        except np.linalg.LinAlgError as error:
            raise ValueError("the graph does not hold together: some stops hang on no other") from error


@functools.lru_cache(maxsize=2)
def _structure(unknowns: int, pairs: tuple[tuple[int, int], ...]) -> Structure:
    return Structure.of(unknowns, pairs)
