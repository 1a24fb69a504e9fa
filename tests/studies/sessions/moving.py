"""Furniture that somebody moves between two sessions: a share of what stands in a room, each piece by a step."""

import math
import random
from collections.abc import Iterable
from dataclasses import dataclass, replace

from robotd.sim.buildings.world import Wall, World
from robotd.sim.physics.walls import Plate, Point, WallSegments, clearance_m

_STEP_M = (0.5, 1.5)
_ROOM_M = 0.5
"""What the robot's stops keep round them, or it could not stand there any more."""
_APART_M = 0.05
_TRIES = 400


@dataclass(frozen=True, slots=True)
class Moved:
    """A piece of furniture, where it stood and where it stands."""

    before: Wall
    after: Wall


def moved(world: World, share: float, seed: int) -> tuple[World, tuple[Moved, ...]]:
    """Return the world with a share of its furniture moved, and what was; the first wall is the room.

    Raises:
        ValueError: there is no room to move that share.
    """
    draw = random.Random(f"{world.name}/{seed}/moved")
    room, *pieces = world.wall
    wanted = round(share * len(pieces))
    order = draw.sample(range(len(pieces)), len(pieces))
    done: dict[int, Moved] = {}
    for number in order:
        others = [done[at].after if at in done else piece for at, piece in enumerate(pieces) if at != number]
        step = None if len(done) == wanted else _step(room, others, pieces[number], world, draw)
        if step is not None:
            done[number] = Moved(pieces[number], step)
    if len(done) < wanted:
        raise ValueError(f"{len(done)} of {wanted} pieces could be moved")
    walls = (room, *(done[at].after if at in done else piece for at, piece in enumerate(pieces)))
    return replace(world, wall=walls), tuple(done.values())


def _step(room: Wall, others: Iterable[Wall], piece: Wall, world: World, draw: random.Random) -> Wall | None:
    """Return a piece moved to where it fits; None if that was not found."""
    around = [room, *others]
    walls = WallSegments.of(segment for wall in around for segment in wall.segments())
    for _ in range(_TRIES):
        way_m, towards_rad = draw.uniform(*_STEP_M), draw.uniform(-math.pi, math.pi)
        x_m, y_m = way_m * math.cos(towards_rad), way_m * math.sin(towards_rad)
        after = replace(piece, points_m=tuple((x + x_m, y + y_m) for x, y in piece.points_m))
        if _fits(after, around, walls) and not _is_in_the_way(after, world):
            return after
    return None


def _fits(piece: Wall, around: list[Wall], walls: WallSegments) -> bool:
    room, *others = (Plate(wall.points_m, 0.0) for wall in around)
    rim = _rim(piece)
    within = Plate(piece.points_m, 0.0)
    return (
        all(room.holds(at_m) and clearance_m(walls, at_m) > _APART_M for at_m in rim)
        and not any(other.holds(at_m) for other in others for at_m in rim)
        and not any(within.holds(at_m) for other in others for at_m in other.corners_m)
    )


def _is_in_the_way(piece: Wall, world: World) -> bool:
    walls, within = WallSegments.of(piece.segments()), Plate(piece.points_m, 0.0)
    places = ((world.start.x_m, world.start.y_m), *world.stops_m, *world.probes_m)
    return any(within.holds(at_m) or clearance_m(walls, at_m) < _ROOM_M for at_m in places)


def _rim(piece: Wall) -> list[Point]:
    """Return points along the sides of a piece, no more than 5 cm apart."""
    points = []
    for (x0_m, y0_m), (x1_m, y1_m), *_ in piece.segments():
        steps = math.ceil(math.dist((x0_m, y0_m), (x1_m, y1_m)) / _APART_M)
        points += [(x0_m + (x1_m - x0_m) * k / steps, y0_m + (y1_m - y0_m) * k / steps) for k in range(steps)]
    return points
