"""Everything a mission can be tuned by, gathered from the models it uses."""

from dataclasses import dataclass, field

from robotd.core.grid_spec import GridSpec
from robotd.grid.settings import GridSettings
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.localization.advice import SweepFacts, advice_on
from robotd.localization.judge.judgement import Judgement
from robotd.localization.settings import LocalizationSettings
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion.steering import DrivingSettings
from robotd.planning.settings import PlanningSettings


@dataclass(frozen=True, slots=True)
class MissionSettings:
    """Settings of the rooms that a mission brings together."""

    head_mount: HeadMount
    rangefinder: RangefinderCalibration
    sweep: SweepSettings = field(default_factory=SweepSettings)
    driving: DrivingSettings = field(default_factory=DrivingSettings)
    grid: GridSettings = field(default_factory=GridSettings)
    localization: LocalizationSettings = field(default_factory=LocalizationSettings)
    judgement: Judgement = field(default_factory=Judgement)
    planning: PlanningSettings = field(default_factory=PlanningSettings)

    def advice_on(self, spec: GridSpec) -> str | None:
        """Return which setting cannot work on a map's cells, and what to take; None if all go together."""
        facts = SweepFacts(self.sweep.readings, self.rangefinder.range_max_m, self.grid.between_beams)
        return advice_on(self.localization, spec, facts)
