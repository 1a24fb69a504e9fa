"""The smallest error of every cell: in C what it is in NumPy."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.kernels import AVAILABLE
from robotd.grid.kernels.draw.draw_kernel import NO_HEAD
from robotd.grid.kernels.error_radius.error_radius_kernel import Bodies
from robotd.grid.kernels.shared.packed_map import PackedMap
from tests.support.kernel_tables import needs_native

pytestmark = needs_native

masks = hnp.arrays(
    np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=80), elements=st.sampled_from([0, 0, 0, 1, 2])
)
offsets = st.tuples(st.integers(-90, 90), st.integers(-90, 90))


@st.composite
def bodies(draw: st.DrawFn) -> Bodies:
    chains: list[tuple[int, int]] = []
    readings: list[tuple[int, int, int, int]] = []
    for _ in range(draw(st.integers(1, 5))):
        body = [(0, 0), *draw(st.lists(offsets, max_size=6))]
        head = draw(st.one_of(offsets, st.just((NO_HEAD, NO_HEAD))))
        readings.append((len(chains), len(chains) + len(body), *head))
        chains += body
    lengths = draw(st.lists(st.sampled_from([1, 2, 7, 300, 32767, 65535]), min_size=len(chains), max_size=len(chains)))
    return Bodies(np.array(chains, np.int32), np.array(lengths, np.uint16), np.array(readings, np.int32))


@settings(max_examples=60)
@given(masks, bodies(), st.integers(1, 5), st.sampled_from([1, 2]), st.booleans(), st.sampled_from([1, 3]))
def test_c_finds_what_numpy_finds_60_cases(
    mask: NDArray[np.int8], drawn: Bodies, wanted: int, blocked_by: int, outside: bool, threads: int
) -> None:
    packed = PackedMap.of(
        mask == 0, mask == 1, mask == 1, outside_blocks=outside, outside_ends=outside, blocked_by=blocked_by
    )
    distances = (np.abs(mask.astype(np.int32)) * 7 % 5).astype(np.uint16)
    wanted = min(wanted, len(drawn.readings))
    one, other = (
        kernels.error_radius.share_errors(packed, distances, 3, drawn, wanted, threads=threads) for kernels in AVAILABLE
    )
    assert np.array_equal(one, other)
