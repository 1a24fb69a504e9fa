"""Questions are cut into portions, which a schedule spreads; the answers come in order, with what was known before."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise, tee

from robotd.core.errors import RobotdError
from robotd.evaluation.answered import Answered
from robotd.evaluation.asked_log import AskedLog
from robotd.evaluation.division import Query
from robotd.evaluation.map_facts import MapFacts
from robotd.evaluation.result import CaseResult
from robotd.evaluation.schedule import Schedule
from robotd.evaluation.seeking import Seeking
from robotd.evaluation.which_program import program

PORTION = 32
"""Most cases of a portion. A process makes the map of a portion unless it had one of the same map before, so a short
log, which may have thirty cases, is one portion."""


@dataclass(frozen=True, slots=True, eq=False)
class Portion:
    """Some cases of a question, answered in one go; what is sent to another process."""

    job: Seeking
    queries: tuple[Query, ...]


@dataclass(frozen=True, slots=True)
class PortionAnswer:
    """What comes back of a portion."""

    facts: MapFacts
    results: tuple[CaseResult, ...]


def answered(portion: Portion) -> PortionAnswer:
    """Answer a portion, wherever this is.

    Raises:
        RobotdError: what is installed here is not what the portion comes from; the log makes no map.
    """
    if portion.job.commit != program():
        raise RobotdError(f"a worker has robotd {program()}, and {portion.job.commit} asks it: install the same there")
    results = tuple(map(portion.job, portion.queries))
    return PortionAnswer(portion.job.facts, results)


def ask(
    questions: Iterable[AskedLog], before: Answered, schedule: Schedule, most: int = PORTION
) -> Iterator[tuple[AskedLog, PortionAnswer]]:
    """Ask questions, at most ``most`` cases a portion, and yield the answers in order, at least one for each question.

    What was answered before is not asked again, and stands where it would have come.
    """
    told, spread = tee(part for question in questions for part in _parts(question, before, most))
    answers = schedule(answered, (part.portion for part in spread if part.portion is not None))
    for part in told:
        yield part.question, part.completed(None if part.portion is None else next(answers))


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Some cases of a question, in their order: those that were answered before, and those that are not."""

    question: AskedLog
    cases: tuple[Query | CaseResult, ...]
    facts: MapFacts | None
    """Of the map, if they were told before."""

    @property
    def portion(self) -> Portion | None:
        """What is left to ask; None if nothing is, and the map is known, too."""
        left = tuple(case for case in self.cases if isinstance(case, Query))
        return Portion(self.question.job, left) if left or self.facts is None else None

    def completed(self, answer: PortionAnswer | None) -> PortionAnswer:
        """Return all that is known of it, given the answer to what was left."""
        facts, new = (self.facts, iter(())) if answer is None else (answer.facts, iter(answer.results))
        assert facts is not None, "what has no answer has no portion, and so its map is known"
        return PortionAnswer(facts, tuple(case if isinstance(case, CaseResult) else next(new) for case in self.cases))


def _parts(question: AskedLog, before: Answered, most: int) -> Iterator[_Part]:
    job, queries = question.job, question.queries
    cases = tuple(before.results.get(job.key_of(query), query) for query in queries)
    # As even as can be: of 33 cases a portion of one would cost a map.
    count = max(1, -(-len(cases) // most))
    ends = [len(cases) * number // count for number in range(count + 1)]
    for begin, end in pairwise(ends):
        yield _Part(question, cases[begin:end], before.maps.get(job.digest))
