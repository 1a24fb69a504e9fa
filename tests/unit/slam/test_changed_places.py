"""What changed between two sessions: a chest that was moved is gone and has come, and nothing else is listed."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.sim.physics.walls import Point, WallSegments, ray_cast
from robotd.slam.changed_places import Change, changed_places

SPEC = GridSpec(0.05, -0.5, -0.5, (120, 140))
ROOM = ((0.0, 0.0), (6.0, 0.0), (6.0, 5.0), (0.0, 5.0))
STOPS = [Pose2(1.0, 1.0, 0.2), Pose2(5.0, 1.0, 1.0), Pose2(5.0, 4.0, -2.0), Pose2(1.0, 4.0, 3.0), Pose2(3.0, 0.8, 0.5)]


def box(x_m: float, y_m: float, side_m: float = 0.6) -> tuple[Point, ...]:
    return ((x_m, y_m), (x_m + side_m, y_m), (x_m + side_m, y_m + side_m), (x_m, y_m + side_m))


def session(seed: int, *boxes: tuple[Point, ...], stops: Sequence[Pose2] = STOPS) -> tuple[MapStop, ...]:
    """Return stops among boxes, poses off by 1 cm and 0.2 degrees, ranges by 2 cm, one in twenty wrong."""
    draw = np.random.default_rng(seed)
    around = (ROOM, *boxes)
    walls = WallSegments.of(
        (start, end, math.inf) for one in around for start, end in zip(one, (*one[1:], one[0]), strict=True)
    )
    bearings = [math.tau * number / 240 for number in range(240)]
    made = []
    for pose in stops:
        off = Pose2(*draw.normal(0.0, [0.01, 0.01, 0.0035]).tolist())
        at = pose @ off
        ranges = np.array([ray_cast(walls, (at.x_m, at.y_m), at.heading_rad + bearing) for bearing in bearings])
        wrong = draw.random(240) < 0.05
        ranges = np.where(wrong, draw.uniform(0.3, 6.0, 240), ranges + draw.normal(0.0, 0.02, 240))
        made.append(MapStop.of(Sweep.of(bearings, ranges.tolist(), 6.0), pose))
    return tuple(made)


@pytest.mark.parametrize("seed", range(3))
def test_a_chest_that_was_moved_is_gone_where_it_stood_and_has_come_where_it_stands(seed: int) -> None:
    before, since = session(seed, box(2.0, 2.2)), session(seed + 100, box(3.6, 2.8))
    places = changed_places(before, since, SPEC)
    for place in places:
        x_m, y_m = (2.0, 2.2) if place.change is Change.GONE else (3.6, 2.8)
        assert x_m - 0.1 <= place.box.west_m < place.box.east_m <= x_m + 0.7
        assert y_m - 0.1 <= place.box.south_m < place.box.north_m <= y_m + 0.7
        assert place.cells >= 3
    assert {place.change for place in places} == set(Change)


@pytest.mark.parametrize("seed", range(3))
def test_where_nothing_was_moved_nothing_is_listed(seed: int) -> None:
    assert changed_places(session(seed, box(2.0, 2.2)), session(seed + 100, box(2.0, 2.2)), SPEC) == ()


def test_what_one_stop_alone_has_seen_is_not_believed() -> None:
    before, since = session(1, box(2.0, 2.2)), session(2, box(3.6, 2.8), stops=STOPS[:1])
    assert changed_places(before, since, SPEC) == ()
    assert changed_places((), since, SPEC) == ()
