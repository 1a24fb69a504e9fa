"""All settings by which the poses that the count found are judged."""

from dataclasses import dataclass, field

from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.judge.second_look_settings import SecondLookSettings


@dataclass(frozen=True, slots=True)
class Judgement:
    """How poses of high rank are judged and refined."""

    refinement: RefinementSettings = field(default_factory=RefinementSettings)
    second_look: SecondLookSettings = field(default_factory=SecondLookSettings)
