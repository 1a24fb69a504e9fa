"""Everything that array work can be tuned by, gathered from the rooms that do it."""

from dataclasses import dataclass, field

from robotd.grid.settings import GridSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.settings import LocalizationSettings
from robotd.planning.settings import PlanningSettings


@dataclass(frozen=True, slots=True)
class HeadSettings:
    """The same for all jobs."""

    grid: GridSettings = field(default_factory=GridSettings)
    """Of maps that do not say themselves how readings change them."""
    localization: LocalizationSettings = field(default_factory=LocalizationSettings)
    judgement: Judgement = field(default_factory=Judgement)
    error_model: ErrorModel = field(default_factory=ErrorModel)
    planning: PlanningSettings = field(default_factory=PlanningSettings)
