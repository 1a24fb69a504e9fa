"""Fans counted in C are the ones counted in NumPy, added or taken back, by one thread or two."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.grid.fans import FanBeams, direction_keys, draw_fans, start_keys
from robotd.grid.kernels.shared.packed_map import PackedMap, pack
from robotd.grid.kernels.twins import TWINS
from tests.support.kernel_tables import NATIVE, needs_native

pytestmark = needs_native

HEADINGS = 3


def beams_of(random: np.random.Generator, count: int, grown: int) -> FanBeams:
    """Return beams in all directions, some without heads."""
    directions = direction_keys(random.choice([random.uniform(-4.0, 4.0, 6), np.arange(6) * np.pi / 4]))
    starts = start_keys(random.choice([0.0, 1.0]) * random.uniform(-3.0, 3.0, (6, 2)))
    fans = draw_fans(directions, starts, float(random.choice([0.0, 0.01, 0.1])), 200)
    fan = random.integers(0, 6, count)
    crossed = fans.lines_crossed(fan, random.uniform(-1.0, 90.0, count))
    heads = random.integers(-200, 200, (count, 2))
    columns = (crossed, random.integers(0, HEADINGS, count), random.integers(-1, grown, count), heads)
    return FanBeams.of(fans, fan, np.column_stack(columns).astype(np.int32))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.01, 0.1, 0.5]), st.booleans(), st.integers(1, 2))
def test_the_same_counts_30_cases(seed: int, density: float, outside: bool, threads: int) -> None:
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(3, 80, 2).tolist())
    blocking = random.random(shape) < density
    the_map = PackedMap.of(~blocking & (random.random(shape) < 0.9), blocking, blocking, outside_blocks=outside)
    grown = [pack(random.random(shape) < share, the_map.origin, outside=True) for share in (0.3, 0.8)]
    beams = beams_of(random, 25, len(grown))
    one, other = (the_map.blank_counters(HEADINGS, 6) for _ in range(2))
    NATIVE.fans.count_fans(one, the_map, grown, beams, threads=threads)
    TWINS.fans.count_fans(other, the_map, grown, beams)
    assert np.array_equal(one, other)
    some = beams_of(random, 1, len(grown))
    NATIVE.fans.count_fans(one, the_map, grown, some)
    NATIVE.fans.count_fans(one, the_map, grown, some, subtract=True)
    assert np.array_equal(one, other)
    TWINS.fans.count_fans(other, the_map, grown, beams, subtract=True)
    assert not other.any()
