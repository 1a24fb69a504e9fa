"""What a setting may be: bounds that a robot can have, declared once, beside the field that they are about.

A field says ``speed_mps: Annotated[float, Within(0.01, 5.0, "m/s")]``. Its dataclass calls :func:`refuse_outside` when
it is made, and anyone who reads a configuration asks :func:`bounds_of`.
"""

import dataclasses
import functools
import math
import typing
from typing import Any, cast

_SHARE = "of 1"
_SLIPS: dict[str, tuple[tuple[str, float, int], ...]] = {
    "m": (("mm", 1e-3, 1), ("cm", 1e-2, 1), ("km", 1e3, 1)),
    "m/s": (("mm/s", 1e-3, 1), ("cm/s", 1e-2, 1), ("km/h", 1 / 3.6, 1)),
    "m/s^2": (("mm/s^2", 1e-3, 1), ("cm/s^2", 1e-2, 1)),
    "rad": (("deg", math.pi / 180, 1),),
    "rad/s": (("deg/s", math.pi / 180, 1), ("turns/min", math.tau / 60, 1)),
    "rad/s^2": (("deg/s^2", math.pi / 180, 1),),
    "s": (("ms", 1e-3, 1), ("us", 1e-6, 1)),
    "ms": (("s", 1e3, 1), ("us", 1e-3, 1)),
    "Hz": (("s", 1.0, -1), ("ms", 1e3, -1)),
    "V": (("mV", 1e-3, 1),),
    "bytes": (("MiB", 2.0**20, 1), ("KiB", 2.0**10, 1)),
    "counts/m": (("m/count", 1.0, -1), ("counts/mm", 1e3, 1), ("mm/count", 1e3, -1)),
    "counts/rad": (("rad/count", 1.0, -1), ("counts/deg", 180 / math.pi, 1), ("deg/count", 180 / math.pi, -1)),
    _SHARE: (("%", 1e-2, 1),),
}
"""For each unit those it is mistaken for: ``(name, factor, power)``, our value is ``factor * theirs ** power``."""


@dataclasses.dataclass(frozen=True, slots=True)
class Within:
    """The least and the most that a number may be, both included."""

    least: float
    most: float
    unit: str = ""
    """In which it is counted, as in ``m/s``; ``of 1`` for a share."""
    either_sign: bool = False
    """Whether the bounds are those of its size, and the sign is free."""

    def complaint(self, value: float, usual: float | None = None) -> str | None:
        """Return what is wrong with a value, or None; with the unit that was likely meant.

        Args:
            value: what is judged.
            usual: what the value mostly is: of several units that might be meant, that which comes nearest is named.

        >>> Within(0.01, 5.0, "m/s").complaint(400, usual=0.4)
        'must be 0.01 to 5 m/s, got 400; mm/s? then 0.4'
        """
        if self._holds(value):
            return None
        unit = f" {self.unit}" if self.unit not in {"", _SHARE} else ""
        sign = ", of either sign" if self.either_sign else ""
        bounds = f"must be {_short(self.least)} to {_short(self.most)}{unit}{sign}"
        return f"{bounds}, got {repr(value).removesuffix('.0')}{self._meant(value, usual)}"

    def _holds(self, value: float) -> bool:
        return self.least <= (abs(value) if self.either_sign else value) <= self.most

    def _meant(self, value: float, usual: float | None) -> str:
        if value == 0 or not math.isfinite(value):
            return ""
        meant = [(name, factor * value**power) for name, factor, power in _SLIPS.get(self.unit, ())]
        possible = [(name, ours) for name, ours in meant if self._holds(ours)]
        if not possible:
            return ""
        # By ratio: 4 and 0.04 are equally far from 0.4.
        name, ours = min(possible, key=lambda item: abs(math.log(abs(item[1] / usual)))) if usual else possible[0]
        return f"; {name}? then {ours:.3g}"


@functools.cache
def bounds_of(kind: type[Any]) -> dict[str, Within]:
    """Return the bounds of the fields of a dataclass, by name, in their order."""
    hints = typing.get_type_hints(kind, include_extras=True)
    found = {field.name: bounds_in(hints[field.name]) for field in dataclasses.fields(cast("Any", kind))}
    return {name: bounds for name, bounds in found.items() if bounds is not None}


def bounds_in(hint: Any) -> Within | None:
    """Return the bounds that a type carries, if it carries any."""
    return next((item for item in getattr(hint, "__metadata__", ()) if isinstance(item, Within)), None)


def refuse_outside(settings: object) -> None:
    """Check every field of a dataclass that has bounds.

    Raises:
        ValueError: one is out of them; the message begins with its name.
    """
    kind: Any = type(settings)
    usual = {field.name: field.default for field in dataclasses.fields(kind)}
    for name, bounds in bounds_of(kind).items():
        default: Any = usual[name]
        complaint = bounds.complaint(getattr(settings, name), default if isinstance(default, int | float) else None)
        if complaint is not None:
            raise ValueError(f"{name} {complaint}")


def _short(bound: float) -> str:
    return str(bound) if isinstance(bound, int) else f"{bound:.6g}"
