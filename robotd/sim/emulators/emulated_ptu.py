"""An emulated FLIR / Directed Perception pan/tilt unit: its ASCII commands on top of a head's physics."""

import math
import re

from robotd.sim.emulators.speaking import Speaking
from robotd.sim.physics.plant import HeadPlant

ARC_SECONDS_PER_STEP = 185.142857
_STEP_RAD = math.radians(ARC_SECONDS_PER_STEP / 3600.0)
_RESET_US = 8_000_000
_SETTING = {"S": "speed", "A": "acceleration", "B": "base speed", "U": "upper speed limit", "L": "lower speed limit"}
_COMMAND = re.compile(r"([A-Za-z]+)([+-]?\d+)?")
_NAMES = {"P": "Pan", "T": "Tilt"}
_MODES = {"FT", "FV", "ED", "EE", "LE", "LD", "CI", "I"}
_HALTS = {"H", "HP", "HT"}


class PtuEmulator(Speaking):
    """Echoes and is verbose until told otherwise, as after power-up."""

    def __init__(self, plant: HeadPlant) -> None:
        super().__init__()
        self._plant = plant
        low_pan, high_pan, low_tilt, high_tilt = (limit / _STEP_RAD for limit in plant.limits_rad)
        # Rounded inwards: what it names as a limit it can reach.
        self._limits = {
            "P": (math.ceil(low_pan), math.floor(high_pan)),
            "T": (math.ceil(low_tilt), math.floor(high_tilt)),
        }
        self._goal = {"P": 0, "T": 0}
        self._echoes = True
        self._is_terse = False
        self._enforces = True
        self._typed = ""
        self._now_us = 0
        self._reset_done_us: int | None = None
        self._waits = False

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self.advance(now_us)
        for character in data.decode("ascii", errors="replace"):
            if character not in " \r\n":
                self._typed += character
                continue
            typed, self._typed = self._typed, ""
            if typed:
                self._obey(typed)

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        if (due_us := self.next_event_us) is not None and due_us <= now_us:
            self._pass(due_us)
        self._pass(now_us)

    @property
    def next_event_us(self) -> int | None:
        """When something falls due."""
        if self._reset_done_us is not None:
            return self._reset_done_us
        return self._plant.arrives_us if self._waits else None

    def hit_limit(self, axis: str) -> None:
        """Lose steps: an axis was pushed to its stop."""
        self._said += f"!{axis}".encode()

    def _pass(self, to_us: int) -> None:
        self._now_us = max(self._now_us, to_us)
        self._plant.advance(self._now_us)
        if self._reset_done_us is not None and self._reset_done_us <= self._now_us:
            self._reset_done_us = None
            self._goal = {"P": 0, "T": 0}
            self._plant.aim(0.0, 0.0)
            self._said += b"!T!T!P!P*"  # to find its stops it meets them, and says so
            self._end()
        # `A` is answered when the head has arrived, however long that takes.
        if self._waits and (self._plant.arrives_us or 0) <= self._now_us:
            self._waits = False
            self._done("A")

    def _obey(self, typed: str) -> None:
        found = _COMMAND.fullmatch(typed)
        if found is None:
            self._refuse(typed, "Illegal Command Entered")
            return
        letters, number = found[1].upper(), None if found[2] is None else int(found[2])
        if self._waits or self._reset_done_us is not None:
            if letters == "H":
                self._plant.halt()
            return
        if letters == "R":
            self._reset()
        elif letters == "A":
            self._await()
        elif letters in _MODES or letters in _HALTS:
            self._done(typed)
            self._switch(letters)
        elif letters[0] in "PT" and len(letters) == 2:
            self._axis(typed, letters[0], letters[1], number)
        else:
            self._refuse(typed, "Illegal Command Entered")

    def _switch(self, letters: str) -> None:
        self._echoes = (self._echoes or letters == "EE") and letters != "ED"
        self._is_terse = (self._is_terse or letters == "FT") and letters != "FV"
        self._enforces = (self._enforces or letters == "LE") and letters != "LD"
        if letters in _HALTS:
            self._halt()

    def _axis(self, typed: str, axis: str, what: str, number: int | None) -> None:
        low, high = self._limits[axis]
        name = _NAMES[axis]
        if what in "PO":
            if number is None:
                at = self._at(axis) if what == "P" else self._goal[axis]
                self._done(typed, at, f"{'Current' if what == 'P' else 'Target'} {name} position is")
            else:
                self._move(typed, axis, number + (self._goal[axis] if what == "O" else 0))
        elif what in "NX" and number is None:
            self._done(
                typed, low if what == "N" else high, f"{'Minimum' if what == 'N' else 'Maximum'} {name} position is"
            )
        elif what == "R" and number is None:
            self._done(typed, ARC_SECONDS_PER_STEP, "", " seconds arc per position")
        elif what in _SETTING:
            if number is None:
                self._done(typed, 1000, f"{name} {_SETTING[what]} is", " positions/sec")
            else:
                self._done(typed)
        else:
            self._refuse(typed, "Illegal Command Entered")

    def _move(self, typed: str, axis: str, goal: int) -> None:
        low, high = self._limits[axis]
        if self._enforces and not low <= goal <= high:
            side, limit = ("Maximum", high) if goal > high else ("Minimum", low)
            self._refuse(typed, f"{side} allowable {_NAMES[axis]} position is {limit}")
            return
        self._goal[axis] = min(max(goal, low), high)
        self._plant.aim(self._goal["P"] * _STEP_RAD, self._goal["T"] * _STEP_RAD)
        self._done(typed)

    def _at(self, axis: str) -> int:
        pan_rad, tilt_rad = self._plant.angles_rad
        return round((pan_rad if axis == "P" else tilt_rad) / _STEP_RAD)

    def _halt(self) -> None:
        self._plant.halt()
        self._goal = {"P": self._at("P"), "T": self._at("T")}

    def _reset(self) -> None:
        self._plant.halt()
        self._reset_done_us = self._now_us + _RESET_US

    def _await(self) -> None:
        self._waits = True
        if self._plant.arrives_us is None:
            self._waits = False
            self._done("A")

    def _done(self, typed: str, value: float | None = None, before: str = "", after: str = "") -> None:
        self._echo(typed)
        self._said += b"*"
        if value is not None:
            text = f"{value:g}" if isinstance(value, int) else f"{value:.6f}"
            words = text if self._is_terse else f"{before} {text}{after}".strip()
            self._said += f" {words}".encode()
        self._end()

    def _refuse(self, typed: str, text: str) -> None:
        self._echo(typed)
        self._said += f"! {text}".encode()
        self._end()

    def _echo(self, typed: str) -> None:
        if self._echoes:
            self._said += f"{typed} ".encode()

    def _end(self) -> None:
        self._said += b"\r\n"
