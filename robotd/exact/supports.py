"""What curves lie on: lines and halves of circles, as graphs over x; and the predicates of the sweep.

A support runs from left to right (a vertical line: upwards), and *above* it means to the left of that direction. With
the sweep line leaning a little, so that it meets lower points first, a vertical line is a graph over x like any other.
"""

from robotd.exact.points import Point
from robotd.exact.rationals import Rational
from robotd.exact.surds import Number, approximation, compare, sign, sqrt

_ROUNDING = 2.0**-49
"""More than the relative error of the few float operations of one predicate."""


class SupportLine:
    """``a x + b y = c`` with b = 1, or with a = -1 and b = 0 if it is vertical; a is rational, c may have roots."""

    __slots__ = ("_floats", "a", "b", "c")

    def __init__(self, a: Rational, b: Rational, c: Number) -> None:
        self.a, self.b, self.c = a, b, c
        self._floats = (*approximation(a), *approximation(c))

    @classmethod
    def normalized(cls, a: Rational, b: Rational, c: Number) -> "SupportLine":
        """Return the line ``a x + b y = c``."""
        # b / b, not 1: a one of the same arithmetic as all the rest.
        return cls(a / b, b / b, c / b) if b != 0 else cls(-a / a, b, -c / a)

    @classmethod
    def through(cls, point: Point, dx: Rational, dy: Rational) -> "SupportLine":
        """Return the line through a point in a direction."""
        return cls.normalized(-dy, dx, point.y * dx - point.x * dy)

    @property
    def bend(self) -> Rational | int:
        """Its curvature, counter-clockwise positive, squared with its sign."""
        return 0

    def direction(self, _: Point) -> tuple[Number, Number]:
        """Return the way it runs."""
        return self.b, -self.a

    def side(self, point: Point) -> int:
        """Return 1 for a point above, 0 for one on it, -1 for one below."""
        a, a_error, c, c_error = self._floats
        of_x, of_y = a * point.x_float, point.y_float if self.b else 0.0
        value = of_x + of_y - c
        error = abs(a) * point.x_error + a_error * (abs(point.x_float) + point.x_error) + point.y_error + c_error
        error += _ROUNDING * (abs(of_x) + abs(of_y) + abs(c))
        if abs(value) > error:
            return 1 if value > 0.0 else -1
        return sign(self.a * point.x + self.b * point.y - self.c)

    def height(self, x: Number) -> Number:
        """Return y at an x; the line must not be vertical."""
        return self.c - self.a * x

    def moved(self, dx: Rational, dy: Rational) -> "SupportLine":
        """Return the line this far away."""
        return SupportLine(self.a, self.b, self.c + (self.a * dx + self.b * dy))


class HalfCircle:
    """The upper or the lower half of a circle; centre and square of the radius are rational."""

    __slots__ = ("_floats", "r2", "upper", "x", "y")

    def __init__(self, x: Rational, y: Rational, r2: Rational, *, upper: bool) -> None:
        self.x, self.y, self.r2, self.upper = x, y, r2, upper
        self._floats = (*approximation(x), *approximation(y), *approximation(r2))

    @property
    def bend(self) -> Rational:
        """Its curvature, counter-clockwise positive, squared with its sign."""
        return -1 / self.r2 if self.upper else 1 / self.r2

    def direction(self, point: Point) -> tuple[Number, Number]:
        """Return the way it runs at a point of it."""
        dx, dy = point.x - self.x, point.y - self.y
        return (dy, -dx) if self.upper else (-dy, dx)

    def side(self, point: Point) -> int:
        """Return 1 for a point above, 0 for one on it, -1 for one below; the half must reach over or under it."""
        half = 1 if self.upper else -1
        # Beyond the centre's height only the other half could answer, and this one lies on the far side of it.
        if compare(point.y, self.y) == -half:
            return -half
        return half * self.outside(point)

    def outside(self, point: Point) -> int:
        """Return 1 for a point outside the circle, 0 for one on it, -1 for one within."""
        x, x_error, y, y_error, r2, r2_error = self._floats
        dx, dy = point.x_float - x, point.y_float - y
        value = dx * dx + dy * dy - r2
        dx_error = point.x_error + x_error + _ROUNDING * abs(dx)
        dy_error = point.y_error + y_error + _ROUNDING * abs(dy)
        error = (2.0 * abs(dx) + dx_error) * dx_error + (2.0 * abs(dy) + dy_error) * dy_error + r2_error
        if abs(value) > error + _ROUNDING * (dx * dx + dy * dy + r2):
            return 1 if value > 0.0 else -1
        exact_dx, exact_dy = point.x - self.x, point.y - self.y
        return sign(exact_dx * exact_dx + exact_dy * exact_dy - self.r2)

    def height(self, x: Number) -> Number:
        """Return y at an x; the half must reach there."""
        dx = x - self.x
        root = sqrt(self.r2 - dx * dx)
        return self.y + root if self.upper else self.y - root

    def moved(self, dx: Rational, dy: Rational) -> "HalfCircle":
        """Return the half this far away."""
        return HalfCircle(self.x + dx, self.y + dy, self.r2, upper=self.upper)

    def has(self, point: Point) -> bool:
        """Return whether a point of the circle is on this half; the ends of the halves are on both."""
        return compare(point.y, self.y) != (-1 if self.upper else 1)


Support = SupportLine | HalfCircle


def order_after(one: Support, other: Support, point: Point) -> int:
    """Return -1 if one is below the other just right of a common point, 1 if above, 0 if they are the same there.

    By direction, and where they touch by curvature: lines and circles that agree in both are one.
    """
    dx, dy = one.direction(point)
    other_dx, other_dy = other.direction(point)
    turn = sign(other_dx * dy - other_dy * dx)
    if turn:
        return turn
    if sign(dy) * sign(other_dy) < 0:  # both are vertical there: a lower half begins downwards, an upper half upwards
        opposite = sign(dx * other_dx + dy * other_dy) < 0
        if opposite:
            return sign(dy)
    return sign(one.bend - other.bend)


def crossings(one: Support, other: Support) -> tuple[Point, ...]:
    """Return the points that two supports share, left to right; none if they are parallel, concentric or the same."""
    if isinstance(one, SupportLine):
        return _two_lines(one, other) if isinstance(other, SupportLine) else _line_and_half(one, other)
    if isinstance(other, SupportLine):
        return _line_and_half(other, one)
    return _two_halves(one, other)


def _two_lines(one: SupportLine, other: SupportLine) -> tuple[Point, ...]:
    determinant = one.a * other.b - other.a * one.b
    if determinant == 0:
        return ()
    x = (one.c * other.b - other.c * one.b) / determinant
    return (Point(x, (other.c * one.a - one.c * other.a) / determinant),)


def _line_and_half(line: SupportLine, half: HalfCircle) -> tuple[Point, ...]:
    return tuple(point for point in _line_and_circle(line.a, line.b, line.c, half) if half.has(point))


def _line_and_circle(a: Rational, b: Rational, c: Number, circle: HalfCircle) -> tuple[Point, ...]:
    """Return where ``a x + b y = c`` meets the whole circle."""
    distance = c - a * circle.x - b * circle.y
    norm = a * a + b * b
    left = circle.r2 * norm - distance * distance
    touching = sign(left)
    if touching < 0:
        return ()
    foot_x, foot_y = circle.x + a / norm * distance, circle.y + b / norm * distance
    if touching == 0:
        return (Point(foot_x, foot_y),)
    root = sqrt(left)
    along_x, along_y = b / norm * root, -a / norm * root
    points = Point(foot_x - along_x, foot_y - along_y), Point(foot_x + along_x, foot_y + along_y)
    return points if points[0] < points[1] else points[::-1]


def _two_halves(one: HalfCircle, other: HalfCircle) -> tuple[Point, ...]:
    dx, dy = other.x - one.x, other.y - one.y
    if dx == 0 and dy == 0:
        return ()
    squares = other.x * other.x + other.y * other.y - one.x * one.x - one.y * one.y
    power = (one.r2 - other.r2 + squares) / 2  # the line of equal power meets both where they meet
    return tuple(point for point in _line_and_circle(dx, dy, power, one) if one.has(point) and other.has(point))
