"""A map is its stops: laid in one after the other, by the settings it was begun with, they come to its grid again."""

from dataclasses import dataclass, field, replace

from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.reading import Tilt
from robotd.grid.arithmetic import arithmetic
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings

_SEVERAL = "several"
"""In the place of an arithmetic: part of the stops were laid in by another one."""


@dataclass(frozen=True, slots=True)
class MapStops:
    """What a grid was made of, from nothing known on."""

    settings: GridSettings
    """How readings change the cells, at every stop; what it says of size is of no account here."""
    stops: tuple[MapStop, ...] = ()
    """In the order in which they were laid in, which matters: evidence decays, so later stops weigh more."""
    arithmetic: str = field(default_factory=arithmetic)
    """By which they were laid in, see :func:`robotd.grid.arithmetic.arithmetic`."""

    @property
    def is_of_this_arithmetic(self) -> bool:
        """Whether the grid they were made into must come out here bit for bit."""
        return self.arithmetic == arithmetic()

    def with_stop(self, stop: MapStop) -> "MapStops":
        """Return these and one more, which was laid in here."""
        # Once mixed it stays so: no machine makes all of these cells again, bit for bit.
        same = self.arithmetic if self.is_of_this_arithmetic else _SEVERAL
        return replace(self, stops=(*self.stops, stop), arithmetic=same)

    @property
    def tilts(self) -> tuple[Tilt, ...]:
        """The further tilts of its layers, ascending, each with the cut-off that it was looked at with last."""
        latest = {slant.tilt.tilt_rad: slant.tilt for stop in self.stops for slant in stop.slants}
        return tuple(latest[tilt_rad] for tilt_rad in sorted(latest))

    def layer(self, tilt_rad: float) -> "MapStops":
        """Return what a layer was made of: the stops from which the robot looked at that tilt, as a map of its own."""
        seen = (stop.at(tilt_rad) for stop in self.stops)
        return replace(self, stops=tuple(stop for stop in seen if stop is not None))

    def grid_on(self, spec: GridSpec) -> OccupancyGrid:
        """Return the grid that they make on these cells. O(stops x readings x cells a beam)."""
        grid = OccupancyGrid(spec, settings=self.settings)
        # One by one and in order: cells saturate and decay, so their order is part of what they say.
        for stop in self.stops:
            grid.lay_in(stop)
        return grid
