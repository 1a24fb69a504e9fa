"""Cases over processes: all answered once, and a process that dies costs nothing but time."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotd.core.errors import RobotdError
from robotd.evaluation import processes
from robotd.evaluation.processes import over_processes
from robotd.evaluation.schedule import AHEAD

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("no_tracker_is_left")]


def double(number: int) -> int:
    return 2 * number


class DiesOnce:
    """Kills its process at one case, the first time that it is asked."""

    def __init__(self, mark: Path, case: int) -> None:
        self._mark, self._case = mark, case

    def __call__(self, number: int) -> int:
        if number == self._case and not self._mark.exists():
            self._mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return 2 * number


def dies(number: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_every_case_is_answered_once_and_in_order() -> None:
    assert list(over_processes(2)(double, range(100))) == [2 * number for number in range(100)]


def test_a_killed_process_is_replaced_and_nothing_is_lost(tmp_path: Path) -> None:
    answers = list(over_processes(2)(DiesOnce(tmp_path / "mark", 13), range(40)))
    assert answers == [2 * number for number in range(40)]


def test_what_kills_every_process_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "_DEATHS_MAX", 1)
    with pytest.raises(RobotdError, match="processes died 2 times over the same cases"):
        list(over_processes(1)(dies, range(3)))


def test_no_more_cases_are_taken_than_are_under_way() -> None:
    taken = []

    def source() -> Iterator[int]:
        for number in range(1000):
            taken.append(number)
            yield number

    answers = over_processes(1)(double, source())
    next(answers)
    assert len(taken) == AHEAD
    answers.close()  # type: ignore[attr-defined]  # a generator
