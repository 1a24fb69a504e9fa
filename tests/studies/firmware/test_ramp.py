"""The ramp for motors: a speed that follows its goal, exactly, at a bounded acceleration."""

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.studies.firmware.compiling import C, build, run

MILLION = 1_000_000


@pytest.fixture(scope="session")
def ramp(built: Path) -> Path:
    return build(built / "ramp", [Path(__file__).with_name("ramp.c"), C / "ramp.c"])


def told(program: Path, acceleration: int, limit: int, steps: list[tuple[str, int]]) -> list[tuple[int, int]]:
    """Return, after each step, what the motor is set to and the speed in millionths."""
    lines = [f"{acceleration} {limit}", *(f"{word} {number}" for word, number in steps)]
    said = run(program, "\n".join(lines).encode()).splitlines()
    return [(int(speed), int(millionths)) for speed, millionths in (line.split() for line in said)]


def expected(acceleration: int, limit: int, steps: list[tuple[str, int]]) -> Iterator[tuple[int, int]]:
    goal = speed = 0
    for word, number in steps:
        match word:
            case "H":
                goal = max(-min(limit, 32767), min(number, limit)) * MILLION
            case "C":
                goal = speed = 0
            case _:
                speed = (
                    min(goal, speed + acceleration * number)
                    if goal > speed
                    else max(goal, speed - acceleration * number)
                )
        yield abs(speed) // MILLION * (1 if speed >= 0 else -1), speed


@pytest.mark.parametrize("seed", range(5))
def test_the_speed_is_the_one_of_whole_numbers(ramp: Path, seed: int) -> None:
    dice = random.Random(seed)
    acceleration, limit = dice.choice([0, 600, 3000, (1 << 32) - 1]), dice.choice([0, 900, 65535])
    moves = {"H": lambda: dice.randrange(-32768, 32768), "A": lambda: dice.choice([0, 1, 999, 5000, (1 << 32) - 1])}
    steps = [(word, moves[word]() if word in moves else 0) for word in dice.choices("HAAAC", k=300)]
    assert told(ramp, acceleration, limit, steps) == list(expected(acceleration, limit, steps))


def test_how_time_is_cut_up_changes_nothing(ramp: Path) -> None:
    once = told(ramp, 600, 900, [("H", 300), ("A", 400_000)])
    often = told(ramp, 600, 900, [("H", 300), *[("A", 7)] * 57_142, ("A", 6)])
    assert once[-1] == often[-1] == (240, 240 * MILLION)
