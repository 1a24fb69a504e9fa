"""The emulated boards on the script of ``peer.c``: what they do must be what the C does, line for line.

A *told* script is, for each of its lines but those of the plant: what the plant was made to do, what was sent, and when
the board must wake, its state and its faults.
"""

import re
from pathlib import Path

from firmware_proto.c_devices import dictionary_in
from firmware_proto.common import BoardKind, Fault
from firmware_proto.rangefinder_messages import ShotStatus
from robotd.sim.boards.drive_board import DriveBoard
from robotd.sim.boards.emulated_board import Board
from robotd.sim.boards.pantilt_board import PanTiltBoard
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.physics.plant import ShotAnswer
from tests.studies.firmware.compiling import CODEC, C, build, run

Told = tuple[tuple[str, ...], str, str]
_NEVER = (1 << 64) - 1
_PER_RAD = 10_000


def build_peer(directory: Path) -> Path:
    """Compile the program."""
    firmware = ("board.c", "devices.c", "drive.c", "outbox.c", "pantilt.c", "rangefinder.c")
    sources = [Path(__file__).with_suffix(".c"), *(C / name for name in (*CODEC, *firmware))]
    return build(directory / "peer", sources)


def told_by_c(program: Path, kind: BoardKind, script: str) -> list[Told]:
    """Return what the firmware does on a script."""
    return read_told(run(program, script.encode(), kind.name.lower()))


def read_told(text: str) -> list[Told]:
    """Return what a program told."""
    told = []
    calls: list[str] = []
    sent = ""
    for line in text.splitlines():
        match line[0]:
            case "!":
                calls.append(line[2:])
            case ">":
                sent += line[2:]
            case _:
                told.append((tuple(calls), sent, line[2:]))
                calls, sent = [], ""
    return told


class ScriptedPlant:
    """Every plant at once; measures what it was told, and notes what it is made to do."""

    limits_rad = (-2.7, 2.7, -0.8, 0.5)

    def __init__(self) -> None:
        self.numbers = [0] * 8
        self.calls: list[str] = []
        self.arrives_us: int | None = None
        self._now_us = 0

    def advance(self, to_us: int) -> None:
        self.calls.append(f"advance {to_us}")
        self._now_us = to_us
        if self.arrives_us is not None and self.arrives_us <= to_us:
            self.arrives_us = None

    def command(self, speed_mps: float, turn_radps: float) -> None:
        self.calls.append(f"command {round(speed_mps * 1000)} {round(turn_radps * 1000)}")

    def cut(self) -> None:
        self.calls.append("cut")

    @property
    def counts(self) -> tuple[int, int]:
        return self.numbers[0], self.numbers[1]

    @property
    def velocity(self) -> tuple[float, float]:
        return self.numbers[2] / 1000, self.numbers[3] / 1000

    @property
    def bumpers(self) -> int:
        return self.numbers[4]

    @property
    def battery_mv(self) -> int:
        return self.numbers[5]

    @property
    def broken(self) -> Fault:
        return Fault(self.numbers[7])

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        self.calls.append(f"aim {round(pan_rad * _PER_RAD)} {round(tilt_rad * _PER_RAD)}")
        self.arrives_us = self._now_us + self.numbers[2]

    def halt(self) -> None:
        self.calls.append("halt")
        self.arrives_us = None

    @property
    def angles_rad(self) -> tuple[float, float]:
        return self.numbers[0] / _PER_RAD, self.numbers[1] / _PER_RAD

    def switch(self, *, on: bool) -> None:
        self.calls.append(f"light {int(on)}")

    def shoot(self, at_us: int) -> ShotAnswer:
        self.calls.append(f"shoot {at_us}")
        range_mm, strength, status, takes_us = self.numbers[:4]
        return ShotAnswer(ShotStatus(status), range_mm / 1000, strength, takes_us)


def first_difference(script: str, ours: list[Told], theirs: list[Told]) -> str | None:
    """Return the first line of a script after which two differ, and what each did; None if they do not."""
    lines = [line for line in script.splitlines() if line[0] != "P"]
    for line, one, other in zip(lines, ours, theirs, strict=True):
        if one != other:
            return f"{line}\n  {one}\n  {other}"
    return None


def told_by_python(kind: BoardKind, script: str) -> list[Told]:
    """Return what the emulated board does on a script."""
    plant = ScriptedPlant()
    board = _powered_up(kind, plant, 7)
    told = []
    for line in script.splitlines():
        if line[0] == "P":
            plant.numbers = [int(word) for word in line.split()[1:]]
            continue
        board = _step(board, kind, plant, line)
        next_us = _NEVER if board.next_event_us is None else board.next_event_us
        told.append(
            (tuple(plant.calls), board.take_output().hex(), f"{next_us} {int(board.state)} {int(board.faults)}")
        )
        plant.calls.clear()
    return told


def _step(board: Board, kind: BoardKind, plant: ScriptedPlant, line: str) -> Board:
    word, number, *data = line.split()
    match word:
        case "B":
            return _powered_up(kind, plant, int(number))
        case "A":
            board.advance(int(number))
        case _:
            heard = bytes.fromhex("".join(data))
            # Firmware takes byte by byte: a report never counts an error that comes behind the frame it answers.
            for packet in re.findall(b"[^\0]*\0|[^\0]+$", heard, re.DOTALL) or [b""]:
                board.receive(packet, int(number))
    return board


def _powered_up(kind: BoardKind, plant: ScriptedPlant, boot_id: int) -> Board:
    board: Board
    match kind:
        case BoardKind.DRIVE:
            plant.cut()
            board = DriveBoard(plant, boot_id=boot_id)
        case BoardKind.PANTILT:
            plant.halt()
            board = PanTiltBoard(plant, boot_id=boot_id)
        case BoardKind.RANGEFINDER:
            plant.switch(on=False)
            board = RangefinderBoard(plant, boot_id=boot_id)
    dictionary = dictionary_in((C / "devices.c").read_text(encoding="utf-8"), kind)
    assert dictionary is not None
    board._dictionary = dictionary  # compressed by whatever library wrote the C
    return board
