"""All settings by which the poses that the count found are judged."""

from dataclasses import dataclass, field, replace

from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.judge.second_look_settings import SecondLookSettings


@dataclass(frozen=True, slots=True)
class Judgement:
    """How poses of high rank are judged and refined."""

    refinement: RefinementSettings = field(default_factory=RefinementSettings)
    second_look: SecondLookSettings = field(default_factory=SecondLookSettings)

    def no_surer(self, contrast_min: float) -> "Judgement":
        """Return the judgement of one who asks for this contrast, if that is more."""
        look = self.second_look
        # Only ever stricter: who looks until it is sure asks more often, and chance has more tries.
        if contrast_min <= look.contrast_min:
            return self
        off_walls = max(contrast_min, look.contrast_off_walls_min)
        return replace(self, second_look=replace(look, contrast_min=contrast_min, contrast_off_walls_min=off_walls))
