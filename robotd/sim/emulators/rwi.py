"""An emulated RWI base: its two-letter ASCII commands on top of a synchro-drive's physics."""

import math
import re

from robotd.hardware.wire.rwi_ascii import BUMPERS_NONE, ITEMS, TICKS_PER_S
from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import BumperWatch, DrivePlant

COUNTS_PER_M = 27_300.0
COUNTS_PER_TURN = 1024.0
_PLANT_COUNTS_PER_M = 27_300.0
_PLANT_COUNTS_PER_RAD = 4_096.0
COUNTS_PER_RAD = -COUNTS_PER_TURN / math.tau
"""The base counts clockwise."""
_US_PER_TICK = 1_000_000 / TICKS_PER_S
_POSITION_UNIT_COUNTS = 256
_COMMAND = re.compile(r"([A-Z]{2}|[TR][-+<>])(?: +([0-9A-Fa-f]{1,8}))?")
_AXES = ("T", "R")


class RwiEmulator(Speaking):
    """Ramps as its plant does; stops by itself when its watchdog runs out or, unless told otherwise, when bumped."""

    def __init__(self, plant: DrivePlant) -> None:
        super().__init__()
        self._plant = plant
        self._bumper_watch = BumperWatch(plant)
        self._typed = bytearray()
        self._has_failed = False
        self._echoes = True
        self._speeds = {"T": 0, "R": 0}
        self._directions = {"T": 0, "R": 0}
        self._now_us = 0
        self._watchdog_us: int | None = None
        self._report_every_us = 0
        self._report_us: int | None = None
        self._mask = 0
        self._bumpers = 0
        self._stops_on_bump = True

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        # As after power-up; HD ends it, and until then a host hears itself.
        if self._echoes:
            self._said += data
        self._typed += data
        while (end := self._typed.find(b"\r")) >= 0:
            typed = bytes(self._typed[:end]).decode("ascii", errors="replace").strip()
            del self._typed[: end + 1]
            found = _COMMAND.fullmatch(typed)
            if found:
                self._obey(found[1], None if found[2] is None else int(found[2], 16))

    def advance(self, now_us: int) -> None:
        """Let time pass; what falls due on the way happens at its own time."""
        while (due_us := self.next_event_us) is not None and due_us <= now_us:
            self._pass(due_us)
        self._pass(now_us)

    @property
    def next_event_us(self) -> int | None:
        """When something falls due."""
        due_us = (self._watchdog_us, self._report_us, self._bumper_watch.due_us)
        return min((at for at in due_us if at is not None), default=None)

    def fail(self) -> None:
        """Report a servo error and run no motor until it is acknowledged."""
        self._has_failed = True
        self._halt()
        self._say("%TERR")

    def _pass(self, to_us: int) -> None:
        self._now_us = max(self._now_us, to_us)
        self._plant.advance(self._now_us)
        self._bumper_watch.looked(self._now_us)
        self._feel()
        # The one protection that needs no host: each set-point of ours arms it again.
        if self._watchdog_us is not None and self._watchdog_us <= self._now_us:
            self._watchdog_us = None
            self._halt()
            self._say("%WDT motors stopped")
        if self._report_us is not None and self._report_us <= self._now_us:
            self._report_us += self._report_every_us
            self._report()

    def _feel(self) -> None:
        bumpers = self._plant.bumpers
        if bumpers != self._bumpers:
            self._bumpers = bumpers
            self._say(f"%BS {self._switches():04X}")
            # In its firmware, without asking: the host hears of it when it has stopped.
            if bumpers and self._stops_on_bump:
                self._halt()

    def _switches(self) -> int:
        """Return the switches, active low, two for each panel of 45 degrees, clockwise."""
        pressed = 0
        for bit in range(16):
            if self._bumpers & 1 << bit:
                pressed |= 1 << (-bit % 16)
        return BUMPERS_NONE & ~pressed

    def _obey(self, name: str, argument: int | None) -> None:
        axis, what = name[0], name[1]
        if axis in _AXES and what in ("HLW" if self._has_failed else "V+-HLW"):
            self._drive(axis, what, argument)
        elif name == "KI":
            self._directions = {"T": 0, "R": 0}
            self._plant.cut()
        elif name == "WD" and argument is not None:
            self._watchdog_us = self._now_us + round(argument * _US_PER_TICK) if argument else None
        elif name == "BV":
            self._say(f"BV {round(self._plant.battery_mv / 100):X}")
        elif name == "CL":
            self._say(f"CL {round(self._now_us / _US_PER_TICK) % 0x100000000:X}")
        elif name == "EA":
            self._has_failed = False
        else:
            self._set_up(name, argument)

    def _set_up(self, name: str, argument: int | None) -> None:
        if name == "HD":
            self._echoes = False
        elif name == "BE" and argument is not None:
            self._stops_on_bump = argument == 0
        elif name == "SD" and argument is not None:
            self._mask = argument
        elif name == "SP" and argument is not None:
            self._report_every_us = round(argument * _US_PER_TICK)
            self._report_us = self._now_us + self._report_every_us if argument else None

    def _drive(self, axis: str, what: str, argument: int | None) -> None:
        if what == "W":
            self._say(f"{axis}W {self._counts()[_AXES.index(axis)] % 0x100000000:08X}")
            return
        if what == "V" and argument is not None:
            self._speeds[axis] = argument
        elif what in "+-":
            self._directions[axis] = 1 if what == "+" else -1
        elif what in "HL":
            self._directions[axis] = 0
        self._command()

    def _halt(self) -> None:
        self._directions = {"T": 0, "R": 0}
        self._command()

    def _command(self) -> None:
        signed = {axis: self._speeds[axis] * self._directions[axis] for axis in _AXES}
        self._plant.command(signed["T"] / COUNTS_PER_M, signed["R"] / COUNTS_PER_RAD)

    def _counts(self) -> tuple[int, int]:
        translate, rotate = self._plant.counts
        return (
            round(translate / _PLANT_COUNTS_PER_M * COUNTS_PER_M),
            round(rotate / _PLANT_COUNTS_PER_RAD * COUNTS_PER_RAD),
        )

    def _report(self) -> None:
        speed_mps, turn_radps = self._plant.velocity
        values = {
            "CLK": round(self._now_us / _US_PER_TICK) % 0x100000000,
            "BBS": self._switches(),
            "BPX": (0x8000 + self._counts()[0] // _POSITION_UNIT_COUNTS) % 0x10000,
            "BPY": 0x8000,
            "TPH": self._counts()[1] % int(COUNTS_PER_TURN),
            "TVE": min(round(abs(speed_mps) * COUNTS_PER_M), 0xFFFF),
            "RVE": min(round(abs(turn_radps * COUNTS_PER_RAD)), 0xFFFF),
        }
        self._say("%PSR")
        for bit, item in enumerate(ITEMS):
            if self._mask & 1 << bit:
                self._say(f"{item} {values.get(item, 0):0{8 if item == 'CLK' else 4}X}")

    def _say(self, line: str) -> None:
        self._said += line.encode("ascii") + b"\r\n"
