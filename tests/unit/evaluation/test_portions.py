"""Questions in portions: answers in the order of the cases, whatever was known before; no map that nobody needs."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import pytest

from robotd.core.errors import RobotdError
from robotd.evaluation import portions
from robotd.evaluation.answered import Answered
from robotd.evaluation.asked_log import AskedLog
from robotd.evaluation.portions import Portion, PortionAnswer, answered, ask
from robotd.evaluation.protocol import Protocol
from robotd.evaluation.recorded import Reach
from robotd.evaluation.result import CaseResult
from robotd.evaluation.schedule import Answer, Case, in_this_process
from robotd.evaluation.seeking import SeekingSettings
from robotd.grid.settings import GridSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.settings import LocalizationSettings
from robotd.logs.carmen import parse_carmen
from tests.support.recorded_room import drive_lines

SETTINGS = SeekingSettings(Reach(4.0, 3.0), LocalizationSettings(), Judgement(), ErrorModel(), 1)


@pytest.fixture(scope="module")
def question() -> AskedLog:
    log, cells = parse_carmen(drive_lines(30)), GridSettings(rows=1, cols=1, raise_alpha=0.5, lower_alpha=0.9)
    return AskedLog.of("room.log", log, Protocol("half"), cells, SETTINGS, cases=5, seed=0)


class Counted:
    """A schedule that remembers what it was given."""

    def __init__(self) -> None:
        self.given: list[list[int]] = []

    def __call__(self, job: Callable[[Case], Answer], cases: Iterable[Case], /) -> Iterator[Answer]:
        for case in cases:
            assert isinstance(case, Portion)
            self.given.append([query.number for query in case.queries])
            yield job(case)


def told(parts: Iterable[tuple[AskedLog, PortionAnswer]]) -> list[CaseResult]:
    return [replace(result, cpu_s=0.0, wall_s=0.0, answers=()) for _, answer in parts for result in answer.results]


def test_pieces_are_even_and_their_answers_are_those_of_one_piece(question: AskedLog) -> None:
    schedule, numbers = Counted(), [query.number for query in question.queries]
    parts = told(ask([question], Answered(), schedule, 2))
    assert schedule.given == [numbers[:1], numbers[1:3], numbers[3:]]
    assert [result.key.scan for result in parts] == numbers
    assert parts == told(ask([question], Answered(), in_this_process))


def test_what_was_answered_stands_where_it_would_have_come_and_a_known_map_is_not_made(question: AskedLog) -> None:
    [(_, whole)] = ask([question], Answered(), in_this_process)
    known = {result.key: result for result in whole.results}
    some = Answered({key: known[key] for key in list(known)[1:3]}, {question.job.digest: whole.facts})
    schedule = Counted()
    assert told(ask([question], some, schedule)) == told([(question, whole)])
    assert [len(given) for given in schedule.given] == [3]
    everything = Answered(known, some.maps)
    assert told(ask([question, question], everything, schedule)) == 2 * told([(question, whole)])
    assert len(schedule.given) == 1


def test_without_cases_there_is_still_a_map_to_tell_of(question: AskedLog) -> None:
    [(_, answer)] = ask([replace(question, queries=())], Answered(), in_this_process)
    assert answer.results == ()
    assert answer.facts.occupied_cells > 0


def test_a_worker_of_another_program_answers_nothing(question: AskedLog, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(portions, "program", lambda: "another")
    with pytest.raises(RobotdError, match="a worker has robotd another, and"):
        answered(Portion(question.job, question.queries))
