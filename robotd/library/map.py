"""A map to ask where a sweep was taken: NumPy in and out, no daemon, no event loop."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate
from robotd.core.errors import MapError, RobotdError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.grid.tables import NO_INFORMATION
from robotd.library.explanation import Explanation
from robotd.localization.at_stop import estimator_at_stop
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings
from robotd.maps.store import MapStore

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARGIN_M = 0.5
"""Round what the sweeps saw; walls want cells on both of their sides."""

PoseLike = Pose2 | Sequence[float]
"""A pose, or its x [m], y [m] and heading [rad]."""


class Map:
    """An occupancy grid and how it is read. It never changes; what localizing needs is worked out at the first ask.

    The daemon's own localizer with its defaults answers, so a notebook and a robot say the same of the same sweep.
    """

    def __init__(self, grid: OccupancyGrid, settings: LocalizationSettings | None = None) -> None:
        """Read a grid, which must not change any more; most callers want :meth:`from_file` or :meth:`from_sweeps`."""
        self._grid = grid
        self._settings = settings or LocalizationSettings()

    @classmethod
    def from_file(
        cls,
        file: str | Path,
        *,
        resolution_m: float | None = None,
        origin_m: tuple[float, float] = (0.0, 0.0),
        settings: LocalizationSettings | None = None,
    ) -> "Map":
        """Read a map of ROS's map_server (``map.yaml`` and the picture beside it), or a picture alone.

        Args:
            file: the yaml, or a PGM, PNG or BMP picture.
            resolution_m: of a picture alone: metres per pixel.
            origin_m: of a picture alone: its lower-left corner, map frame.
            settings: what counts as explained, and what as an answer.

        Raises:
            MapError: a file cannot be read, or is no such map.
            RobotdError: the extra ``interop`` is not installed.
        """
        try:
            from robotd.interop.read_map import read_map  # noqa: PLC0415  # Pillow and PyYAML are an extra
        except ImportError as error:
            raise RobotdError(f"maps of other programs need the extra interop ({error})") from error
        return cls(read_map(Path(file).expanduser(), resolution_m, origin_m).grid, settings)

    @classmethod
    def from_store(
        cls,
        directory: str | Path,
        name: str,
        version: int | None = None,
        *,
        settings: LocalizationSettings | None = None,
    ) -> "Map":
        """Read a map that a daemon saved, every byte checked; the newest version, if none is given.

        Raises:
            MapError: there is no such map, or it is damaged.
        """
        return cls(MapStore(Path(directory).expanduser()).load(name, version).grid, settings)

    @classmethod
    def from_sweeps(
        cls,
        sweeps: Iterable[Sweep],
        poses: Iterable[PoseLike],
        *,
        grid: GridSettings | None = None,
        settings: LocalizationSettings | None = None,
    ) -> "Map":
        """Make a map of sweeps and the poses they were taken at. O(sweeps x readings x cells a beam).

        Args:
            sweeps: what was seen, in the order in which it was seen: evidence decays.
            poses: where, one for each, map frame.
            grid: size of a cell, and how readings change it; the map is as large as the sweeps, whatever this says.
            settings: what counts as explained, and what as an answer.

        Raises:
            MapError: there are no sweeps, or the map would be too large.
            ValueError: there are more sweeps than poses, or fewer.
        """
        stops = [(sweep, _pose(pose)) for sweep, pose in zip(sweeps, poses, strict=True)]
        if not stops:
            raise MapError("a map is made of at least one sweep")
        chosen = grid or GridSettings(rows=1, cols=1)
        try:
            spec = chosen.spec_covering([point for stop in stops for point in _seen_m(*stop)], _MARGIN_M)
        except ValueError as error:
            raise MapError(str(error)) from error
        made = OccupancyGrid(spec, settings=chosen)
        for sweep, pose in stops:
            made.insert(sweep, pose)
        return cls(made, settings)

    @classmethod
    def from_cells(
        cls,
        cells: NDArray[np.uint8],
        resolution_m: float,
        origin_m: tuple[float, float] = (0.0, 0.0),
        *,
        settings: LocalizationSettings | None = None,
    ) -> "Map":
        """Take cells as :attr:`cells` gives them, ``uint8[rows, cols]``, row 0 at the least y; they are copied.

        Raises:
            ValueError: they are of another type or shape, or a number is impossible.
        """
        array = np.asarray(cells)
        if array.ndim != 2:
            raise ValueError(f"expected uint8[rows, cols], got {array.dtype}{list(array.shape)}")
        spec = GridSpec(resolution_m, *origin_m, (array.shape[0], array.shape[1]))
        return cls(OccupancyGrid(spec, array), settings)

    @property
    def cells(self) -> NDArray[np.uint8]:
        """Return a copy of the cells, ``uint8[rows, cols]``: 0 surely vacant, 128 unknown, 255 surely occupied."""
        return self._grid.cells.copy()

    @property
    def spec(self) -> GridSpec:
        """Where the cells lie."""
        return self._grid.spec

    def localize(
        self,
        sweep: Sweep,
        *,
        heading_rad: float | None = None,
        near_m: tuple[float, float, float] | None = None,
    ) -> PoseEstimate:
        """Say where a sweep was taken, or that it is not sure.

        Args:
            sweep: what was seen.
            heading_rad: what a compass or odometry says of the robot's heading; None is nothing.
            near_m: x, y and radius of a disk in which the robot is known to be; None is anywhere.
        """
        settings = self._settings
        headings_rad = settings.headings_all_round() if heading_rad is None else settings.headings_near(heading_rad)
        within = None if near_m is None else Area(*map(float, near_m))
        localizer = estimator_at_stop(self._ready, "", headings_rad, within)
        localizer.add(*sweep.measured)
        return localizer.estimate(0, final=True)

    def explain(self, sweep: Sweep, pose: PoseLike) -> Explanation:
        """Say which readings of a sweep this map explains from a pose, and how far each beam should have gone."""
        return Explanation.of(self._ready, sweep, _pose(pose))

    def expected_ranges(self, bearings_rad: NDArray[np.float64], pose: PoseLike) -> NDArray[np.float64]:
        """Return how far a perfect laser at a pose would measure, ``float64[n]`` for bearings ``float64[n]`` [m].

        A beam ends at the side of the cell that stops it: an obstacle, or where nobody has looked.
        """
        bearings_rad = np.asarray(bearings_rad, np.float64)
        sweep = Sweep.of(bearings_rad, np.ones(len(bearings_rad)), cutoff_m=2.0)  # its ranges do not matter
        return self.explain(sweep, pose).expected_m

    def plot(
        self, estimate: PoseEstimate | None = None, sweep: Sweep | None = None, axes: "Axes | None" = None
    ) -> "Axes":
        """Draw the map to scale in metres, with the answers of an estimate and, at its best, the sweep.

        Raises:
            RobotdError: the extra ``plots`` is not installed.
        """
        try:
            from robotd.library.map_plot import plot_map  # noqa: PLC0415  # matplotlib is an extra
        except ImportError as error:
            raise RobotdError(f"plots need the extra plots ({error})") from error
        explanation = None
        if estimate is not None and estimate.best is not None and sweep is not None:
            explanation = self.explain(sweep, estimate.best)
        return plot_map(self._grid, estimate, explanation, axes)

    def __repr__(self) -> str:
        """Say how large it is, and how much of it was seen."""
        rows, cols = self.spec.shape
        seen = float((self._grid.cells != NO_INFORMATION).mean())
        return f"Map({cols} x {rows} cells of {self.spec.resolution_m * 1000:g} mm, {seen:.0%} seen)"

    @cached_property
    def _ready(self) -> ReadyMap:
        return ReadyMap.of(self._grid, self._settings)


def _pose(pose: PoseLike) -> Pose2:
    if isinstance(pose, Pose2):
        return pose
    x_m, y_m, heading_rad = map(float, pose)
    return Pose2(x_m, y_m, heading_rad)


def _seen_m(sweep: Sweep, pose: Pose2) -> list[tuple[float, float]]:
    """Return where the robot stood and the hits it saw: misses clear what others see, and need no room of their own."""
    hits = (reading for reading in sweep.measured if reading.status is ReadingStatus.OK)
    ends = (
        (
            reading.origin_x_m + (reading.range_m or 0.0) * np.cos(reading.bearing_rad),
            reading.origin_y_m + (reading.range_m or 0.0) * np.sin(reading.bearing_rad),
        )
        for reading in hits
    )
    return [(pose.x_m, pose.y_m), *(pose.transform(*end) for end in ends)]
