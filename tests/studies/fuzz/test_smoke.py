"""Each parser, for a moment: what ``make fuzz`` does for a minute."""

import pytest

from tests.studies.fuzz import corpus
from tests.studies.fuzz.coverage import Coverage
from tests.studies.fuzz.hunt import KEPT_MAX, failure_of, hunt, smallest_set
from tests.studies.fuzz.target import Target
from tests.studies.fuzz.targets import TARGETS


@pytest.mark.parametrize("name", TARGETS)
def test_nothing_but_typed_errors_leaves_a_parser_and_its_memory_is_bounded(name: str) -> None:
    target = TARGETS[name]
    found = hunt(target, corpus.load(name)[: target.executions], executions=target.executions)
    assert found.broken is None, f"{found.broken[0].hex()}\n{found.broken[1]}"
    assert found.executions > target.executions
    assert found.peak_bytes < target.peak_max
    assert found.kept_bytes < KEPT_MAX


@pytest.mark.parametrize("name", TARGETS)
def test_what_each_parser_begins_with_is_understood(name: str) -> None:
    for seed in TARGETS[name].seeds():
        TARGETS[name].run(seed)


def _brittle(data: bytes) -> None:
    """Break on what chance alone would hardly find."""
    if data[:1] != b"b":
        return
    if data[1:2] != b"u":
        return
    if data[2:3] == b"g":
        raise ZeroDivisionError


BRITTLE = Target("brittle", _brittle, lambda: [b"aaa"], ("tests/studies/fuzz/test_smoke.py",), size_max=8)


def test_a_hunt_finds_what_only_steps_in_the_right_direction_lead_to() -> None:
    found = hunt(BRITTLE, [], executions=300_000, seed=1)
    assert found.broken is not None
    assert found.broken[0].startswith(b"bug")
    assert "ZeroDivisionError" in found.broken[1]


def test_a_parser_that_keeps_what_it_is_fed_is_found_out() -> None:
    class Hoarder:
        def __init__(self) -> None:
            self.kept: list[bytes] = []

        def feed(self, data: bytes) -> list[bytes]:
            self.kept.append(bytes(bytearray(data)))
            return []

    hoarding = Target(
        "hoarder", Hoarder().feed, lambda: [b"abc"], ("tests/studies/fuzz/test_smoke.py",), stream=Hoarder
    )
    assert hunt(hoarding, [], executions=10).kept_bytes > KEPT_MAX


def test_the_smallest_set_reaches_what_all_reach() -> None:
    inputs = [b"a", b"ab", b"b", b"bu", b"bux", b"bu again"]
    chosen = smallest_set(BRITTLE, inputs)

    def reached(some: list[bytes]) -> int:
        coverage = Coverage(BRITTLE.files)
        with coverage.watching():
            for data in some:
                failure_of(BRITTLE, data)
        return len(coverage.arcs)

    assert len(chosen) < len(inputs)
    assert reached(chosen) == reached(inputs)
