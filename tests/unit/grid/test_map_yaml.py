"""The yaml of a map: full precision, as a real yaml parser reads it."""

import yaml
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.grid.map_yaml import map_yaml

finite = st.floats(allow_nan=False, allow_infinity=False)
specs = st.builds(GridSpec, st.floats(1e-300, 1e300), finite, finite, st.just((4, 4)))


@given(specs)
def test_other_programs_read_every_number_exactly(spec: GridSpec) -> None:
    loaded = yaml.safe_load(map_yaml("map.pgm", spec))
    assert set(loaded) == {"image", "mode", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}
    assert loaded["resolution"] == spec.resolution_m
    assert loaded["origin"] == [spec.origin_x_m, spec.origin_y_m, 0.0]


def test_it_is_what_map_server_writes() -> None:
    assert map_yaml("hall.pgm", GridSpec(0.05, -10.0, -2.5, (4, 4))) == (
        "image: hall.pgm\nmode: trinary\nresolution: 0.05\norigin: [-10.0, -2.5, 0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
