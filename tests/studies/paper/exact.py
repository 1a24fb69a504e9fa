"""The exact answer to a test, on the room's true polygons: what the robot's map and its cells are held against."""

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes

from robotd.cli.pictures.exact_sets import fill
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.exact.arrangement import Arrangement
from robotd.exact.beams import Beam, beam
from robotd.exact.feasible import PolygonMap, best_rank, of_rank, ranked
from robotd.exact.formats import map_of_toml
from robotd.exact.planar import PlanarSet
from robotd.exact.rationals import rational
from robotd.sim.buildings.world import WORLDS_DIR
from tests.studies.paper.rooms import Room
from tests.studies.paper.trials import ERROR_M

_MAP = "#dfe4e8"


def obstacles_of(room: Room) -> PlanarSet:
    """Return all that is solid in a room, and all beyond it."""
    return map_of_toml((WORLDS_DIR / f"{room.name}.toml").read_text(encoding="utf-8"))


def exact_ranks(obstacles: PlanarSet, readings: Sequence[RangeReading], heading_rad: float) -> Arrangement:
    """Return where each reading is feasible, for a known heading and the eps of all tests."""
    beams = [_beam(reading, heading_rad) for reading in readings]
    return ranked(PolygonMap(obstacles, rational(str(ERROR_M))), beams)


def exact_panel(room: Room, readings: Sequence[RangeReading], heading_rad: float) -> tuple[str, Callable[[Axes], None]]:
    """Return a panel: white where no reading is feasible, black where the most are."""
    obstacles = obstacles_of(room)
    ranks = exact_ranks(obstacles, readings, heading_rad)
    best = best_rank(ranks)

    def draw(axes: Axes) -> None:
        fill(axes, obstacles, _MAP)
        for rank in range(1, best + 1):
            fill(axes, of_rank(ranks, rank), str(1.0 - rank / best), zorder=1.0 + rank / best)

    return f"(d) exact, on the true walls; black: {best} of {len(readings)}", draw


def _beam(reading: RangeReading, heading_rad: float) -> Beam:
    """Return a reading to the micrometre; one that measured nothing cannot count."""
    assert reading.origin_x_m == reading.origin_y_m == 0.0, "the beam starts at the robot's axis"
    reach = rational(f"{reading.range_m:.6f}")
    return beam(heading_rad + reading.bearing_rad, reach, is_hit=reading.status is ReadingStatus.OK)
