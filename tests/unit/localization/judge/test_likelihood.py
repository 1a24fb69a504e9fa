"""The likelihood of a reading: what it rewards, what it forgives, what it does not mind."""

import math
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.grid_spec import GridSpec
from robotd.grid.readings import Readings
from robotd.grid.window import CellWindow
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.likelihood import Likelihood

SPEC = GridSpec(0.05, 0.0, -1.0, (40, 200))
HERE = np.array([[1.0, 0.0, 0.0]])


def hallway(wall: int = 250) -> Likelihood:
    """Vacant up to a wall at 5 m, vacant behind it up to 7 m, and unknown from there on."""
    cells = np.full(SPEC.shape, 128, np.uint8)
    cells[:, :140] = 20
    cells[:, 100] = wall
    return Likelihood.of(SPEC, cells, ErrorModel())


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.integers(0, 39), st.integers(0, 30)),
    st.tuples(st.integers(0, 199), st.integers(0, 90)),
)
def test_a_likelihood_that_was_updated_is_as_if_made_anew(
    seed: int, rows: tuple[int, int], cols: tuple[int, int]
) -> None:
    random = np.random.default_rng(seed)
    kinds = np.array([20, 20, 20, 128, 200], np.uint8)
    cells = np.repeat(np.repeat(random.choice(kinds, (4, 20)), 10, axis=0), 10, axis=1)
    likelihood = Likelihood.of(SPEC, cells, ErrorModel())
    before = likelihood.chances.skips.copy()
    window = CellWindow(rows[0], min(40, sum(rows)), cols[0], min(200, sum(cols)))
    cells[window.slices] = random.choice(kinds, window.shape)
    updated, remade = likelihood.updated(cells, window), Likelihood.of(SPEC, cells, ErrorModel())
    np.testing.assert_array_equal(updated.chances.cells, remade.chances.cells)
    np.testing.assert_array_equal(updated.chances.skips, remade.chances.skips)
    np.testing.assert_array_equal(updated.on_walls, remade.on_walls)
    assert updated.vacant_cells == remade.vacant_cells
    np.testing.assert_array_equal(likelihood.chances.skips, before)


def logs(likelihood: Likelihood, *ranges_m: float, misses: bool = False, bearing_rad: float = 0.0) -> list[float]:
    readings = np.array([[bearing_rad, range_m, 0.0, 0.0, float(misses)] for range_m in ranges_m])
    values: list[float] = likelihood.logs(likelihood.sight(Readings(readings)), HERE)[0].tolist()
    return values


def test_the_wall_is_likeliest_and_errors_cost_by_their_size() -> None:
    at_wall, off_5_cm, off_20_cm, far_off = logs(hallway(), 4.025, 4.075, 4.225, 3.0)
    assert at_wall > off_5_cm > off_20_cm > far_off
    assert at_wall - far_off > 4.0


def test_no_reading_costs_more_than_an_outlier() -> None:
    model = ErrorModel()
    worst = math.log(model.outlier_share / model.outlier_span_m)
    assert min(logs(hallway(), *np.arange(0.1, 9.0, 0.1).tolist())) >= worst


def test_something_new_before_the_wall_is_likelier_than_to_see_through_it() -> None:
    before, behind = logs(hallway(), 2.0, 5.0)
    assert before > behind


def test_the_surer_the_wall_the_less_likely_a_beam_goes_through() -> None:
    passed = [logs(hallway(value), 5.5, misses=True)[0] for value in (129, 160, 200, 250)]
    assert passed == sorted(passed, reverse=True)


def test_a_miss_is_likely_where_nothing_stands_and_not_behind_a_wall() -> None:
    free, walled = logs(hallway(), 3.0, 5.0, misses=True)
    assert free > -0.1
    assert walled < -1.9


def test_where_nobody_has_looked_readings_are_as_anywhere() -> None:
    unknown = Likelihood.of(SPEC, np.full(SPEC.shape, 128, np.uint8), ErrorModel(unmapped_per_m=1e-4))
    readings = np.array([[0.3 * k, 0.5 * k, 0.0, 0.0, float(k % 4 == 0)] for k in range(1, 12)])
    sight = unknown.sight(Readings(readings))
    assert np.allclose(unknown.logs(sight, HERE)[0], unknown.elsewhere_logs(sight), atol=0.03)


@pytest.mark.parametrize("cell_m", [0.05, 0.1, 0.2])
def test_however_coarse_the_cells_the_place_beats_being_nowhere(cell_m: float) -> None:
    """A room of 4 x 3 m, on a map of its outlines: at 20 cm a cell says less of a wall than its straightness does."""
    spec = GridSpec(cell_m, -3.0, -3.0, (round(6.0 / cell_m), round(6.0 / cell_m)))
    bearings = 0.01 + np.arange(180) * math.tau / 180
    ways = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    ranges = np.min((1.93 / np.abs(ways[:, 0]), 1.47 / np.abs(ways[:, 1])), axis=0)
    ranges[20:32] = 0.8
    readings = np.column_stack((bearings, ranges, np.zeros((180, 3))))
    cells = np.full(spec.shape, 20, np.uint8)
    cells.ravel()[spec.flat_at(ranges[:, None] * ways)] = 250
    likelihood = Likelihood.of(spec, cells, ErrorModel(mapped_walls_go_on=0.6))
    sight, at = likelihood.sight(Readings(readings)), np.zeros((1, 3))
    assert (likelihood.logs(sight, at)[0] - likelihood.elsewhere_logs(sight)).sum() > 0.0
    cells_alone = likelihood.with_model(ErrorModel(mapped_walls_go_on=0.0))
    gained = likelihood.logs(sight, at)[0] - cells_alone.logs(sight, at)[0]
    assert gained.sum() > 0.0


def test_where_the_map_has_no_wall_none_goes_on() -> None:
    bearings = np.linspace(-0.3, 0.3, 9)
    readings = Readings(np.column_stack((bearings, 2.0 / np.cos(bearings), np.zeros((9, 3)))))
    both = [hallway().with_model(ErrorModel(mapped_walls_go_on=chance)) for chance in (0.0, 0.6)]
    one, other = (likelihood.logs(likelihood.sight(readings), HERE)[0] for likelihood in both)
    assert np.array_equal(one, other)


def test_a_beam_starts_where_the_sensor_sits() -> None:
    likelihood = hallway()
    readings = np.array([[0.0, 3.525, 0.5, 0.2, 0.0], [math.pi / 2, 4.025, 0.0, 0.0, 0.0]])
    turned = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, -math.pi / 2]])
    ahead, left = likelihood.logs(likelihood.sight(Readings(readings)), turned).T
    assert ahead[0] > ahead[1] + 3.0
    assert left[1] == pytest.approx(logs(likelihood, 4.025)[0])


@pytest.mark.parametrize("name", list(asdict(ErrorModel())))
def test_impossible_settings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        ErrorModel(**{name: -1.0})
