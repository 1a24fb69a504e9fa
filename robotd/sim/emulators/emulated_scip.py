"""An emulated Hokuyo UTM-30LX: scans on command, 270 degrees in steps of a quarter."""

import math

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.hardware.wire.scip import OK, sum_of
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import ScannerPlant

_STEPS_PER_TURN, _FIRST, _FRONT, _LAST = 1440, 0, 540, 1080
_RANGE_MIN_MM, _RANGE_MAX_MM = 100, 30_000
_SCAN_US = 25_000
"""One turn of its mirror, which makes 2400 a minute."""
_BLOCK = 64
_CODES = {ShotStatus.OVER_RANGE: 1, ShotStatus.TOO_NEAR: 4}
_OTHER_CODE = 5
_PARAMETERS = {
    "MODL": "UTM-30LX(Hokuyo Automatic Co.,Ltd.)",
    "DMIN": _RANGE_MIN_MM,
    "DMAX": _RANGE_MAX_MM,
    "ARES": _STEPS_PER_TURN,
    "AMIN": _FIRST,
    "AMAX": _LAST,
    "AFRT": _FRONT,
    "SCAN": 2400,
}


class ScipEmulator(Speaking):
    """Its light burns while it scans."""

    def __init__(self, plant: ScannerPlant) -> None:
        super().__init__()
        self._plant = plant
        self._typed = bytearray()
        self._wanted: tuple[int, str] | None = None
        """When the scan under way is done, and the command for it."""

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        self._typed += data
        while (end := self._typed.find(b"\n")) >= 0:
            typed = bytes(self._typed[:end]).decode("ascii", errors="replace").strip()
            del self._typed[: end + 1]
            if typed:
                self._obey(typed, now_us)

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        if self._wanted is not None and self._wanted[0] <= now_us:
            done_us, typed = self._wanted
            self._wanted = None
            self._scan(typed, done_us)

    @property
    def next_event_us(self) -> int | None:
        """When a scan is done."""
        return None if self._wanted is None else self._wanted[0]

    def _obey(self, typed: str, now_us: int) -> None:
        if typed == "PP":
            lines = [f"{key}:{value}" for key, value in _PARAMETERS.items()]
            self._say(typed, OK, [f"{line};{sum_of(line)}" for line in lines])
        elif typed == "QT":
            self._wanted = None
            self._plant.switch(on=False)
            self._say(typed, OK)
        elif typed.startswith("MD") and typed[2:].isdigit() and len(typed) == 15:
            first, last = int(typed[2:6]), int(typed[6:10])
            refusal = "05" if last < first else "04" if last > _LAST else OK
            # Answered twice: at once that it was understood, and with the data when the scan is done.
            self._say(typed, refusal)
            if refusal == OK:
                self._plant.switch(on=True)
                self._wanted = (now_us + _SCAN_US, typed)
        else:
            self._say(typed, "0E")

    def _scan(self, typed: str, at_us: int) -> None:
        steps = range(int(typed[2:6]), int(typed[6:10]) + 1)
        text = "".join(_encoded(self._distance_mm(step, at_us), 3) for step in steps)
        self._plant.switch(on=False)
        stamp = _encoded(at_us // 1000 & 0xFFFFFF, 4)
        blocks = [stamp, *(text[at : at + _BLOCK] for at in range(0, len(text), _BLOCK))]
        self._say(f"{typed[:13]}00", "99", [block + sum_of(block) for block in blocks])

    def _distance_mm(self, step: int, at_us: int) -> int:
        answer = self._plant.measure(at_us, (step - _FRONT) * math.tau / _STEPS_PER_TURN)
        if answer.status is not ShotStatus.OK:
            return _CODES.get(answer.status, _OTHER_CODE)
        return min(max(round(answer.range_m * 1000), _RANGE_MIN_MM), _RANGE_MAX_MM)  # below it numbers are codes

    def _say(self, typed: str, status: str, lines: list[str] | None = None) -> None:
        self._said += "\n".join((typed, status + sum_of(status), *(lines or ()), "", "")).encode()


def _encoded(number: int, characters: int) -> str:
    return "".join(chr((number >> 6 * place & 0x3F) + 0x30) for place in reversed(range(characters)))
