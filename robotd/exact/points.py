"""Points of exact coordinates, ordered as a sweep meets them: by x, then by y."""

from functools import total_ordering

from robotd.exact.surds import Number, Surd, approximation, compare


@total_ordering
class Point:
    """An exact point with its approximation, immutable."""

    __slots__ = ("x", "x_error", "x_float", "y", "y_error", "y_float")
    __hash__ = None  # type: ignore[assignment]  # equal points can be written in different ways

    def __init__(self, x: Number, y: Number) -> None:
        self.x, self.y = x, y
        self.x_float, self.x_error = approximation(x)
        self.y_float, self.y_error = approximation(y)

    def __repr__(self) -> str:
        return f"({self.x}, {self.y})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Point) and compare_points(self, other) == 0

    def __lt__(self, other: "Point") -> bool:
        return compare_points(self, other) < 0

    @property
    def is_rational(self) -> bool:
        """Whether no root is needed to write it."""
        return not isinstance(self.x, Surd) and not isinstance(self.y, Surd)

    @property
    def floats(self) -> tuple[float, float]:
        """Its coordinates, nearly."""
        return self.x_float, self.y_float

    def moved(self, dx: Number, dy: Number) -> "Point":
        """Return the point this far away."""
        return Point(self.x + dx, self.y + dy)


def compare_points(one: Point, other: Point) -> int:
    """Return -1, 0 or 1: by x, then by y."""
    # Ends are shared by borders, and equal numbers are the dearest to compare: no filter can tell them apart.
    if one is other:
        return 0
    apart = one.x_float - other.x_float
    # Twice the bound covers the roundings of this very comparison.
    if abs(apart) > 2.0 * (one.x_error + other.x_error):
        return 1 if apart > 0.0 else -1
    return compare(one.x, other.x) or compare(one.y, other.y)
