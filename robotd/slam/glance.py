"""Where a few readings were taken between two stops: wheels lie by more than a robot keeps clear of walls."""

import numpy as np

from robotd.core.motion_error import Travel
from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.localization.placing import Believed, is_explained, near_prior
from robotd.slam.survey import Survey

_WITHIN_M = 8.0
_STOPS = 15
"""As many as a sweep is placed on, but the nearest: the way leads through ground that was seen long ago."""


def glanced(survey: Survey, readings: Readings, since: Pose2, travel: Travel) -> tuple[Pose2, bool]:
    """Return where a few readings were taken, and whether the map had a word in it; else odometry's, less its bias.

    Args:
        survey: of a map in the making.
        readings: a handful, all round.
        since: where the robot was when that was known last.
        travel: since then.
    """
    settings, graph = survey.settings, survey.graph
    # Less the bias first: wheels that always pull to one side are then looked for where they really lead.
    expected = since @ survey.bias.corrected(travel)
    prior = Believed(expected, settings.motion.covariance(travel))
    about = graph.laid_about(expected, _WITHIN_M)
    nearest = np.sort(about[np.argsort(graph.off_m(expected, about), kind="stable")[:_STOPS]])
    found = near_prior(settings.maps.ground(graph, nearest, expected), readings, prior, settings.placing)
    # A handful of readings finds some wall anywhere: believed only where the map explains them.
    if found is None or not is_explained(found[1], settings.placing):
        return expected, False
    return prior.fused(found[0].pose, np.array(found[0].covariance)).pose, True
