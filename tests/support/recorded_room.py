"""A log of a drive through a room without symmetry: a scanner of 90 beams, a scan every few centimetres."""

import math

import numpy as np

from robotd.sim.physics.walls import WallSegments, ray_cast

_CORNERS = [(0.0, 0.0), (5.0, 0.0), (5.0, 1.5), (3.8, 1.5), (3.8, 3.0), (1.2, 3.0), (1.2, 2.2), (0.0, 2.2)]
ROOM = WallSegments.of(
    (start, end, math.inf) for start, end in zip(_CORNERS, [*_CORNERS[1:], _CORNERS[0]], strict=True)
)
BEAMS = 90
NOTHING_M = 81.83
SIGHT_M = 4.2


def scan_line(x_m: float, y_m: float, heading_rad: float) -> str:
    bearings = heading_rad - math.pi / 2 + math.pi / BEAMS * np.arange(BEAMS)
    seen = [ray_cast(ROOM, (x_m, y_m), float(bearing)) for bearing in bearings]
    ranges = [round(range_m, 2) if range_m < SIGHT_M else NOTHING_M for range_m in seen]
    pose = f"{x_m:.3f} {y_m:.3f} {heading_rad:.4f}"
    return f"FLASER {BEAMS} {' '.join(map(str, ranges))} {pose} {pose} 1 host 1"


def drive_lines(scans: int) -> list[str]:
    """Along the room and back; the robot looks ahead, and a little about."""
    ways = np.linspace(0.0, 2.0, scans)
    return [
        scan_line(
            0.6 + 3.6 * (way if way < 1.0 else 2.0 - way),
            0.9 + 0.3 * math.sin(3.0 * way),
            (0.0 if way < 1.0 else math.pi) + 0.4 * math.sin(11.0 * way),
        )
        for way in ways.tolist()
    ]
