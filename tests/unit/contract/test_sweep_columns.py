"""Readings in columns: what goes in comes out, in single precision; columns that contradict each other are refused."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.contract.sweep_columns import from_columns, in_columns
from robotd.core.errors import RemoteProtocolError
from robotd.core.reading import RangeReading, ReadingStatus

MEASURED = {ReadingStatus.OK, ReadingStatus.MISS}
SINGLE = st.floats(-4.0, 4.0, width=32)


@st.composite
def readings(draw: st.DrawFn) -> RangeReading:
    status = draw(st.sampled_from(ReadingStatus))
    range_m = draw(st.floats(0.125, 30.0, width=32)) if status in MEASURED else None
    x_m, y_m = draw(st.one_of(st.just((0.0, 0.0)), st.tuples(SINGLE, SINGLE)))
    return RangeReading(7, draw(SINGLE), status, range_m, None, x_m, y_m)


@given(st.lists(readings(), min_size=1, max_size=20))
def test_what_goes_in_comes_out(some: list[RangeReading]) -> None:
    told = in_columns(3, 40, some)
    assert (told.number, told.first, told.time_ns) == (3, 40, 7)
    assert from_columns(told) == tuple(some)


def test_nine_bytes_a_reading_if_all_start_at_the_centre() -> None:
    some = [RangeReading(7, 0.1 * at, ReadingStatus.OK, 2.0) for at in range(15)]
    told = in_columns(3, 0, some)
    columns = (told.bearing_f32le, told.range_f32le, told.status_u8, told.origin_x_f32le, told.origin_y_f32le)
    assert sum(map(len, columns)) == 9 * 15


@pytest.mark.parametrize(
    "changes",
    [
        {"bearing_f32le": bytes(4)},
        {"bearing_f32le": bytes(7)},
        {"range_f32le": b""},
        {"status_u8": bytes([0, 200])},
        {"status_u8": bytes([2, 2])},
        {"origin_x_f32le": bytes(12)},
    ],
    ids="-".join,
)
def test_columns_that_contradict_each_other_are_refused(changes: dict[str, bytes]) -> None:
    told = in_columns(3, 0, [RangeReading(7, 0.1, ReadingStatus.OK, 2.0)] * 2)
    with pytest.raises(RemoteProtocolError, match="readings of sweep 3"):
        from_columns(replace(told, **changes))  # type: ignore[arg-type]  # mypy cannot see through the dict
