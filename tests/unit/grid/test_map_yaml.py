"""The yaml of a map: full precision, a strict reader, and agreement with a real yaml parser."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.errors import MapError
from robotd.grid.map_yaml import MapYaml, read_map_yaml

GOOD = MapYaml("room.pgm", 0.05, -6.4, -6.4).text()
finite = st.floats(allow_nan=False, allow_infinity=False)
yamls = st.builds(
    MapYaml,
    st.just("map.pgm"),
    st.floats(1e-300, 1e300),
    finite,
    finite,
    st.booleans(),
    st.floats(0.6, 1.0),
    st.floats(0.0, 0.5),
)


@given(yamls)
def test_every_number_comes_back_exactly(one: MapYaml) -> None:
    assert read_map_yaml(one.text()) == one


@given(yamls)
def test_other_yaml_parsers_read_the_same(one: MapYaml) -> None:
    loaded = yaml.safe_load(one.text())
    assert set(loaded) == {"image", "mode", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}
    assert float(loaded["resolution"]) == one.resolution_m
    assert [float(part) for part in loaded["origin"]] == [one.origin_x_m, one.origin_y_m, 0.0]


def test_what_map_server_writes_is_read() -> None:
    text = (
        "image: hall.pgm\nresolution: 0.050\norigin: [-10.000000, -2.5, 0.000000]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n\n"
    )
    assert read_map_yaml(text) == MapYaml("hall.pgm", 0.05, -10.0, -2.5)


def test_comments_quotes_and_words_for_truth_are_read() -> None:
    text = GOOD.replace("room.pgm", '"room.pgm" # of ours').replace("negate: 0", "negate: true")
    assert read_map_yaml("# a map\n---\n" + text) == MapYaml("room.pgm", 0.05, -6.4, -6.4, negate=True)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("resolution: 0.05\n", "", "no resolution"),
        ("resolution: 0.05", "resolution: 0", "positive"),
        ("resolution: 0.05", "resolution: nan", "not a number"),
        ("resolution: 0.05", "resolution: fine", "not a number"),
        ("mode: trinary", "mode: scale", "only trinary"),
        ("-6.4, 0]", "-6.4, 0.5]", "rotated"),
        ("[-6.4, -6.4, 0]", "[-6.4, -6.4]", "origin"),
        ("[-6.4, -6.4, 0]", "-6.4, -6.4, 0", "origin"),
        ("negate: 0", "negate: 2", "negate"),
        ("0.65", "0.1", "thresholds"),
        ("image: room.pgm", "image: ''", "no image"),
        ("image: room.pgm", "image: a.pgm\nimage: b.pgm", "second time"),
        ("mode: trinary", "colour: red", "unknown key 'colour'"),
        ("mode: trinary", "trinary", "key: value"),
    ],
)
def test_damage_is_named(old: str, new: str, complaint: str) -> None:
    assert old in GOOD
    with pytest.raises(MapError, match=complaint):
        read_map_yaml(GOOD.replace(old, new))


@given(st.text(max_size=80))
def test_garbage_is_a_typed_error(garbage: str) -> None:
    with pytest.raises(MapError):
        read_map_yaml(garbage)
