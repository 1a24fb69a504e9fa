"""What was decided at a stop, and where to go next, as the world is told it."""

from typing import TypeVar

from robotd.contract import events
from robotd.contract.explored import CandidateStop, LeftOpen
from robotd.exploring.choice import Choice
from robotd.head.jobs import Chosen, StopLaid
from robotd.head.stop_placing import MapWithStop
from robotd.localization.outcome import Outcome
from robotd.slam.loops import Loop
from robotd.slam.survey import LoopClosed, LoopHeld, Reconciled, StopPlaced

E = TypeVar("E", events.LoopHeld, events.LoopClosed)


def stop_laid(made: MapWithStop, time_ns: int, map_id: str) -> StopLaid:
    """Return the answer of a job that placed a stop."""
    held, cells, decisions = made.held, made.cells, made.decisions
    assert held.stops is not None
    assert held.survey is not None
    stop = len(held.survey.graph.stops) - 1
    placed = next((one for one in decisions if isinstance(one, StopPlaced)), None)
    reconciled = next((one for one in decisions if isinstance(one, Reconciled)), None)
    return StopLaid(
        # Bytes and not numbers: msgpack would make an object of each, and twice.
        cells=cells.astype("<i8", copy=False).tobytes(),
        # Only what changed: a sweep changes some thousand cells of a map that may have millions.
        values=held.grid.cells.reshape(-1)[cells].tobytes(),
        digest=held.digest,
        stops=len(held.stops.stops),
        placed=_placed(placed, stop, made, time_ns, map_id),
        held=tuple(_loop(events.LoopHeld, one.loop, time_ns, map_id) for one in decisions if isinstance(one, LoopHeld)),
        closed=tuple(
            _loop(events.LoopClosed, one.loop, time_ns, map_id) for one in decisions if isinstance(one, LoopClosed)
        ),
        reconciled=_reconciled(reconciled, time_ns, map_id),
        map_from_robot=made.map_from_robot,
    )


def _placed(one: StopPlaced | None, stop: int, made: MapWithStop, time_ns: int, map_id: str) -> events.StopPlaced:
    if one is None:  # the map begins here, and so do its coordinates
        return events.StopPlaced(time_ns, map_id, stop, Outcome.PLACED.value, made.map_from_robot, 0.0, 0.0, 0.0, 0.0)
    believed, agreed = one.placed.believed, one.placed.agreement
    sure = believed.deviation_m, believed.deviation_rad
    shares = agreed.explained_share, agreed.contradicted_share
    return events.StopPlaced(time_ns, map_id, stop, one.placed.outcome.value, believed.pose, *sure, *shares)


def _reconciled(one: Reconciled | None, time_ns: int, map_id: str) -> events.Reconciled | None:
    if one is None:
        return None
    return events.Reconciled(time_ns, map_id, one.stops_moved, one.largest_move_m, len(one.refused))


def _loop(kind: type[E], loop: Loop, time_ns: int, map_id: str) -> E:
    return kind(time_ns, map_id, loop.stop, loop.old, loop.moved_m, loop.moved_rad)


def chosen(choice: Choice) -> Chosen:
    """Return the answer of a job that chose where to stop next."""
    return Chosen(
        goal_m=choice.goal_m,
        ending=None if choice.ending is None else choice.ending.value,
        candidates=tuple(
            CandidateStop(*one.at_m, one.score, one.area_m2, one.opening_m, one.overlap, one.way_m)
            for one in choice.candidates
        ),
        tour_m=choice.tour_m,
        seen_m2=choice.seen_m2,
        left=tuple(LeftOpen(*one.opening.at_m, one.opening.width_m, one.why.value) for one in choice.left),
    )
