"""The firmware does what the emulated boards do, whatever is asked of it, and what only hardware can ask of it."""

from pathlib import Path

import pytest

from firmware_proto.common import Arm, BoardKind, BoardState, Clear, Configure, Fault, Hello
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim
from firmware_proto.schema import Message
from tests.studies.firmware.peer import Told, first_difference, told_by_c, told_by_python
from tests.studies.firmware.scripts import random_script

each_kind = pytest.mark.parametrize("kind", BoardKind)


@each_kind
@pytest.mark.parametrize("seed", range(3))
def test_a_random_life_is_the_same_in_c_and_in_python(peer: Path, kind: BoardKind, seed: int) -> None:
    script = random_script(kind, seed, 400)
    difference = first_difference(script, told_by_c(peer, kind, script), told_by_python(kind, script))
    assert difference is None, difference


@each_kind
def test_random_lives_come_through_all_states(kind: BoardKind) -> None:
    states = {
        BoardState(int(end.split()[1]))
        for seed in range(3)
        for *_, end in told_by_python(kind, random_script(kind, seed, 400))
    }
    assert states == set(BoardState)


def test_an_instrument_that_must_be_asked_again_and_again_gives_the_same_shots(peer: Path) -> None:
    script = random_script(BoardKind.RANGEFINDER, 9, 400)
    impatient = "\n".join(line[:-1] + "700" if line[0] == "P" else line for line in script.splitlines()) + "\n"
    asked = told_by_c(peer, BoardKind.RANGEFINDER, impatient)
    waited = told_by_c(peer, BoardKind.RANGEFINDER, script)
    assert [one[:2] for one in asked] == [one[:2] for one in waited]
    assert asked != waited


def heard(now_us: int, *requests: Message) -> str:
    wires = (encode_frame(RawFrame(request.TYPE, now_us % 65536, request.to_payload())) for request in requests)
    return f"R {now_us} {b''.join(wires).hex()}"


def ends(told: list[Told]) -> list[tuple[BoardState, Fault]]:
    return [(BoardState(int(state)), Fault(int(faults))) for _, _, end in told for _, state, faults in [end.split()]]


READY = heard(1000, Hello(1, 0, 1), Configure(50, 500), Arm())
BREAKS = {
    (BoardKind.DRIVE, Fault.MOTOR): (SetVelocity(300, 0, 400), "cut"),
    (BoardKind.DRIVE, Fault.BATTERY): (SetVelocity(300, 0, 400), "command 0 0"),
    (BoardKind.PANTILT, Fault.MOTOR): (Aim(100, 100, 400), "halt"),
}


@pytest.mark.parametrize(("kind", "fault"), BREAKS, ids=lambda one: one.name)
def test_what_breaks_stops_the_device_and_cannot_be_cleared_until_it_is_mended(
    peer: Path, kind: BoardKind, fault: Fault
) -> None:
    motion, stop = BREAKS[kind, fault]
    moving = "P 0 0 300000 0 0 0 0 0" if kind is BoardKind.PANTILT else "P 0 0 300 0 0 24000 0 0"
    broken = moving[:-1] + str(int(fault))
    script = [
        moving,
        READY,
        heard(2000, motion),
        broken,
        "A 60000",
        heard(70_000, Clear()),
        moving,
        heard(80_000, Clear()),
    ]
    text = "\n".join(script) + "\n"
    told = told_by_c(peer, kind, text)
    assert first_difference(text, told, told_by_python(kind, text)) is None
    latched = (BoardState.FAULT, fault)
    assert ends(told) == [(BoardState.ARMED, Fault.NONE)] * 2 + [latched] * 2 + [(BoardState.CONFIGURED, Fault.NONE)]
    assert stop in told[2][0]


def test_the_deadman_of_the_firmware_stops_a_base_that_nobody_commands_any_more(peer: Path) -> None:
    script = [
        "P 0 0 300 0 0 24000 0 0",
        READY,
        heard(2000, SetVelocity(300, 0, 250)),
        "A 251999",
        "A 252000",
        "A 900000",
    ]
    told = told_by_c(peer, BoardKind.DRIVE, "\n".join(script) + "\n")
    assert ends(told)[2] == (BoardState.ARMED, Fault.NONE)
    assert ends(told)[3:] == [(BoardState.FAULT, Fault.DEADMAN)] * 2
    assert told[3][0][-1] == "command 0 0"
