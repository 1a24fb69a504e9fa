"""What makes simulated hardware as unreliable as the real thing, repeatably."""

import random
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NoiseSettings:
    """How far the hardware is from ideal. The defaults are those of a well-kept, calibrated robot."""

    range_sigma_m: float = 0.02
    """Standard deviation of a range."""
    outlier_share: float = 0.05
    """Share of readings that have nothing to do with the first obstacle: mixed pixels, people, mirrors."""
    translation_scale_error: float = 0.003
    """How much farther the robot goes than its wheels count, as a share."""
    translation_noise_m: float = 0.002
    """Random error of the way after one metre; grows with its square root."""
    rotation_scale_error: float = 0.0005
    """How much farther the robot turns than its encoder counts, as a share."""
    rotation_noise_rad: float = 0.0005
    """Random error of the heading after turning one radian; grows with its square root."""
    drift_noise_rad: float = 0.001
    """Random error of the heading after driving one metre; grows with its square root."""
    slip_share: float = 0.0005
    """Mean share of the way that is lost to slipping wheels, in uneven bursts."""
    clock_skew_ppm: float = 40.0
    """How much faster or slower than the host's clock a board's may run."""

    def __post_init__(self) -> None:
        """Refuse what no hardware does."""
        for name in ("range_sigma_m", "translation_noise_m", "rotation_noise_rad", "drift_noise_rad", "clock_skew_ppm"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"{name} must not be negative, got {getattr(self, name)}")
        for name in ("outlier_share", "slip_share"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise ValueError(f"{name} must be in [0, 1), got {getattr(self, name)}")
        for name in ("translation_scale_error", "rotation_scale_error"):
            if not abs(getattr(self, name)) < 0.5:
                raise ValueError(f"{name} must be within +-0.5, got {getattr(self, name)}")


NOISELESS = NoiseSettings(
    range_sigma_m=0.0,
    outlier_share=0.0,
    translation_scale_error=0.0,
    translation_noise_m=0.0,
    rotation_scale_error=0.0,
    rotation_noise_rad=0.0,
    drift_noise_rad=0.0,
    slip_share=0.0,
    clock_skew_ppm=0.0,
)
"""Ideal hardware, with ideal clocks."""


def stream(seed: int, purpose: str) -> random.Random:
    """Return the random numbers of one device, which do not depend on what others draw."""
    return random.Random(f"{seed}/{purpose}")  # seeded by a text, alike in every process
