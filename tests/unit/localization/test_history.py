"""A history: never without the true pose while bounds hold, and with nothing that cannot be reached."""

import itertools
import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from robotd.contract.estimate import Circle, Contradiction, Cover, Extent, Region
from robotd.core.angles import wrap_rad
from robotd.core.motion_error import MotionError, Travel
from robotd.core.pose import IDENTITY, Pose2
from robotd.localization.history import History, reached, shared

ROW = (0.0, 0.0, 0.0)
MOTION = MotionError()
Record = Callable[[str, object], None]
WALKS, TWINS, BOXES = 1500, 200, 60
AHEAD = Travel(Pose2(2.0, 0.0, 0.0), 2.0, 0.0)


def region(extent: Extent, belief: float = 0.5) -> Region:
    x_m, y_m = (extent.x_min_m + extent.x_max_m) / 2, (extent.y_min_m + extent.y_max_m) / 2
    pose = Pose2(x_m, y_m, wrap_rad((extent.heading_min_rad + extent.heading_max_rad) / 2))
    circle, cover = Circle(x_m, y_m, 0.1), Cover(1, ())
    return Region(belief, pose, (ROW, ROW, ROW), 0.0, pose, extent, circle, cover, 1, 1, 1, ())


def place(x_m: float, y_m: float = 0.0, heading_rad: float = 0.0, belief: float = 0.5, half_m: float = 0.05) -> Region:
    low_rad = wrap_rad(heading_rad - 0.02)
    return region(Extent(x_m - half_m, x_m + half_m, y_m - half_m, y_m + half_m, low_rad, low_rad + 0.04), belief)


def seen(*regions: Region) -> History:
    return History().looked(regions, Travel(), MOTION).history


def middles(history: History) -> list[tuple[float, float]]:
    extents = [one.extent for one in history.members]
    return [(round((e.x_min_m + e.x_max_m) / 2, 1), round((e.y_min_m + e.y_max_m) / 2, 1)) for e in extents]


def test_of_two_places_the_way_between_two_looks_tells_which() -> None:
    looked = seen(place(0.0), place(10.0, 0.0, math.pi)).looked([place(2.0), place(12.0)], AHEAD, MOTION)
    assert (looked.reachable, looked.only, looked.contradiction) == ((True, False), 0, None)
    assert len(looked.history.members) == 1


def test_places_that_move_alike_stay() -> None:
    looked = seen(place(0.0), place(10.0)).looked([place(2.0), place(12.0)], AHEAD, MOTION)
    assert (looked.reachable, looked.only) == ((True, True), None)


def test_a_first_look_excludes_nothing() -> None:
    looked = History().looked([place(0.0), place(5.0)], AHEAD, MOTION)
    assert looked.reachable == (True, True)
    assert middles(looked.history) == [(0.0, 0.0), (5.0, 0.0)]


def test_a_look_that_may_have_left_a_place_out_excludes_nothing() -> None:
    before = seen(place(0.0))
    looked = before.looked([place(30.0)], AHEAD, MOTION, is_complete=False)
    assert (looked.reachable, looked.contradiction) == ((True,), None)
    assert middles(looked.history) == [(2.0, 0.0)]


def test_a_look_that_believes_in_no_place_excludes_none() -> None:
    looked = seen(place(0.0), place(10.0)).looked([], AHEAD, MOTION)
    assert middles(looked.history) == [(2.0, 0.0), (12.0, 0.0)]


@pytest.mark.parametrize(("off_m", "said"), [(0.6, None), (1.1, Contradiction.SLIPPED), (6.0, Contradiction.CARRIED)])
def test_what_cannot_be_reached_is_a_contradiction_and_it_says_which(off_m: float, said: Contradiction | None) -> None:
    looked = seen(place(0.0)).looked([place(2.0 + off_m)], AHEAD, MOTION)
    assert looked.contradiction is said
    assert looked.reachable == (said is None,)


def test_a_robot_that_was_turned_round_was_carried() -> None:
    looked = seen(place(0.0)).looked([place(0.0, 0.0, math.pi)], Travel(), MOTION)
    assert looked.contradiction is Contradiction.CARRIED


def test_what_was_believed_stays_a_rival_for_two_looks_and_no_longer() -> None:
    history = seen(place(0.0)).looked([place(9.0)], Travel(), MOTION).history
    assert middles(history) == [(9.0, 0.0), (0.0, 0.0)]
    back = history.looked([place(0.0), place(9.0)], Travel(), MOTION)
    assert back.reachable == (True, True)
    for looks_left in (1, 0):
        history = history.looked([place(9.0)], Travel(), MOTION).history
        assert len(history.members) == 1 + looks_left


def test_evidence_adds_up_and_orders_but_excludes_nothing() -> None:
    history = seen(place(0.0, belief=0.3), place(10.0, belief=0.6))
    for _ in range(3):
        looked = history.looked([place(10.0, belief=1e-200), place(0.0, belief=0.9)], Travel(), MOTION)
        assert looked.reachable == (True, True)
        history = looked.history
    assert middles(history) == [(0.0, 0.0), (10.0, 0.0)]
    assert history.members[0].evidence == 0.0
    assert -100.0 < history.members[1].evidence < -50.0


def test_a_corridor_keeps_what_odometry_knows_of_the_way_along_it() -> None:
    corridor = region(Extent(-10.0, 10.0, -0.1, 0.1, -0.02, 0.02))
    looked = seen(place(0.0)).looked([corridor], AHEAD, MOTION)
    extent = looked.history.members[0].extent
    assert 1.0 < extent.x_min_m < 2.0 < extent.x_max_m < 3.0


def test_many_members_are_one_for_each_region() -> None:
    wide = region(Extent(-50.0, 50.0, -50.0, 50.0, -math.pi, math.pi))
    many = seen(*(place(float(x_m)) for x_m in range(40)))
    looked = many.looked([wide, wide], Travel(), MOTION)
    assert len(looked.history.members) == 2


# What the boxes promise, against poses one by one


@dataclass(frozen=True)
class Walk:
    """A random robot: what its wheels said, and where it truly went."""

    seed: int

    def steps(self, count: int) -> list[tuple[Travel, Pose2]]:
        """Return what was told of each step, and the pose after it; the first begins at the origin."""
        draw, pose = random.Random(self.seed), IDENTITY
        steps = []
        for _ in range(count):
            step = Pose2(draw.uniform(-1.0, 3.0), draw.uniform(-1.0, 1.0), draw.uniform(-math.pi, math.pi))
            way_m = math.hypot(step.x_m, step.y_m) * draw.uniform(1.0, 2.0)
            told = Travel(step, way_m, abs(step.heading_rad) * draw.uniform(1.0, 2.0))
            pose = pose @ erred(told, draw)
            steps.append((told, pose))
        return steps


def erred(told: Travel, draw: random.Random) -> Pose2:
    """Return a step that the wheels may have told so: by their bounds, as often as not at the edge of them."""
    off_m, off_rad = MOTION.bounds(told)
    by_m, by_rad = off_m * draw.choice((1.0, draw.random())), off_rad * draw.choice((-1.0, 1.0, draw.uniform(-1, 1)))
    way = draw.uniform(-math.pi, math.pi)
    step = told.step
    return Pose2(
        step.x_m + 0.999 * by_m * math.cos(way),
        step.y_m + 0.999 * by_m * math.sin(way),
        wrap_rad(step.heading_rad + 0.999 * by_rad),
    )


def regions_round(truth: Pose2, draw: random.Random) -> list[Region]:
    """Return regions of which one holds the truth, somewhere; the others lie anywhere."""

    def extent(x_m: float, y_m: float, heading_rad: float) -> Extent:
        left, right, below, above = (draw.uniform(0.0, 0.4) for _ in range(4))
        low_rad = wrap_rad(heading_rad - draw.uniform(0.0, 0.3))
        width_rad = min((heading_rad - low_rad) % math.tau + draw.uniform(0.0, 0.3), math.tau)
        return Extent(x_m - left, x_m + right, y_m - below, y_m + above, low_rad, low_rad + width_rad)

    others = [
        extent(truth.x_m + draw.uniform(-6, 6), truth.y_m + draw.uniform(-6, 6), draw.uniform(-math.pi, math.pi))
        for _ in range(draw.randrange(4))
    ]
    extents = [*others, extent(truth.x_m, truth.y_m, truth.heading_rad)]
    draw.shuffle(extents)
    return [region(one, draw.random()) for one in extents]


def test_the_true_pose_is_never_lost_while_bounds_hold(record_property: Record) -> None:
    record_property("property_cases", WALKS)
    for seed in range(WALKS):
        history, draw = History(), random.Random(seed)
        for told, truth in Walk(seed).steps(6):
            is_complete = draw.random() < 0.8
            found = regions_round(truth, draw)
            found = found if is_complete else found[:-1]
            looked = history.looked(found, told, MOTION, is_complete=is_complete)
            assert looked.contradiction is None, seed
            history = looked.history
            assert history.is_anywhere or any(one.extent.holds(truth) for one in history.members), seed


def possible(poses: list[Pose2], told: Travel, regions: list[Region], draw: random.Random) -> list[Pose2]:
    """Return poses that the robot may be in, each found by trying: the slow twin."""
    tried = [pose @ erred(told, draw) for pose in poses for _ in range(4)]
    return [pose for pose in tried if any(one.extent.holds(pose) for one in regions)][:60]


def test_every_pose_that_some_robot_can_have_come_to_is_held(record_property: Record) -> None:
    record_property("property_cases", TWINS)
    held = 0
    for seed in range(TWINS):
        draw = random.Random(seed)
        (_, begin), *later = Walk(seed).steps(4)
        first = regions_round(begin, draw)
        history, poses = seen(*first), [begin] * 20
        for told, truth in later:
            regions = regions_round(truth, draw)
            history = history.looked(regions, told, MOTION).history
            poses = [*possible(poses, told, regions, draw), truth]
            for pose in poses:
                assert any(one.extent.holds(pose, near_m=1e-9, near_rad=1e-9) for one in history.members), seed
            held += len(poses)
    assert held > 1000


def test_a_box_that_moved_holds_its_moved_poses_and_is_no_larger_than_it_must_be(record_property: Record) -> None:
    record_property("property_cases", BOXES)
    still = MotionError(0.0, 0.0, 0.0, 0.0, 0.0)
    for seed in range(BOXES):
        draw = random.Random(seed)
        low_rad = draw.uniform(-math.pi, math.pi)
        box = Extent(0.0, 0.3, -0.2, 0.2, low_rad, low_rad + draw.choice((0.1, 1.0, 3.0, 6.0)))
        told = Travel(Pose2(draw.uniform(-3, 3), draw.uniform(-3, 3), draw.uniform(-3, 3)), 1.0, 1.0)
        moved = reached(box, told, still)
        ends = [
            Pose2(x_m, y_m, low_rad + share * (box.heading_max_rad - low_rad)) @ told.step
            for x_m, y_m in itertools.product((0.0, 0.3), (-0.2, 0.2))
            for share in (number / 200 for number in range(201))
        ]
        assert all(moved.holds(end, near_m=1e-9, near_rad=1e-9) for end in ends)
        assert moved.x_max_m == pytest.approx(max(end.x_m for end in ends), abs=2e-3)
        assert moved.y_min_m == pytest.approx(min(end.y_m for end in ends), abs=2e-3)


def test_what_two_boxes_share_is_what_both_hold(record_property: Record) -> None:
    record_property("property_cases", BOXES)
    for seed in range(BOXES):
        draw = random.Random(seed)
        one, other = (
            Extent(0.0, 1.0, 0.0, 1.0, low_rad, low_rad + draw.choice((0.2, 2.0, 4.0, math.tau)))
            for low_rad in (draw.uniform(-math.pi, math.pi) for _ in range(2))
        )
        both = shared(one, other)
        for number in range(200):
            pose = Pose2(0.5, 0.5, wrap_rad(number * math.tau / 200))
            if one.holds(pose) and other.holds(pose):
                assert both is not None
                assert both.holds(pose, near_rad=1e-9)
        if both is not None:
            width_rad = both.heading_max_rad - both.heading_min_rad
            assert width_rad <= min(o.heading_max_rad - o.heading_min_rad for o in (one, other)) + 1e-9


def test_boxes_that_lie_apart_share_nothing() -> None:
    one = Extent(0.0, 1.0, 0.0, 1.0, 0.0, 0.1)
    assert shared(one, Extent(2.0, 3.0, 0.0, 1.0, 0.0, 0.1)) is None
    assert shared(one, Extent(0.0, 1.0, 1.5, 2.0, 0.0, 0.1)) is None
    assert shared(one, Extent(0.0, 1.0, 0.0, 1.0, 0.2, 0.3)) is None
