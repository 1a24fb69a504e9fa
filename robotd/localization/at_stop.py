"""Begin to localize at a stop, as the settings have it."""

from collections.abc import Sequence

from robotd.contract.area import Area
from robotd.core.reading import Tilt
from robotd.localization.by_walls import ByWalls
from robotd.localization.estimator import Estimator
from robotd.localization.heading_search import HeadingSearch
from robotd.localization.judge.judgement import Judgement
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.smallest_error_told import SmallestErrorTold


def estimator_at_stop(
    the_map: ReadyMap,
    map_id: str,
    headings_rad: Sequence[float],
    within: Area | None = None,
    *,
    judgement: Judgement | None = None,
    layers: Sequence[tuple[Tilt, ReadyMap]] = (),
    threads: int = 1,
    tells_smallest_error: bool = False,
) -> Estimator:
    """Begin with no readings; arguments as of :meth:`.Localizer.at_stop`.

    Walls are asked for the heading where the settings say so and nothing is known of it. In the conservative mode they
    are not: what they say is no proof.
    """
    settings = the_map.settings
    is_open = tuple(headings_rad) == settings.headings_all_round() and not settings.conservative
    everywhere = Localizer.at_stop(
        the_map, map_id, headings_rad, within, judgement=judgement, layers=layers, threads=threads
    )
    asks_walls = is_open and settings.heading is HeadingSearch.WALLS
    estimator: Estimator = ByWalls(everywhere, within, threads) if asks_walls else everywhere
    return SmallestErrorTold(estimator, the_map, threads) if tells_smallest_error else estimator
