"""Looks for inputs that break a parser: changes what it knows, and keeps what reaches lines that nothing else did."""

import random
import re
import time
import traceback
import tracemalloc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from tests.studies.fuzz.coverage import Arc, Coverage
from tests.studies.fuzz.mutation import mutated
from tests.studies.fuzz.target import KIB, Target

_NUMBER = re.compile(r"[0-9a-f]{8,}|-?\d[\d.e+]*")
_FLOOD_BYTES = 256 * KIB
_PIECE_BYTES = 4 * KIB
KEPT_MAX = 32 * KIB
"""This much may a parser of a stream keep of a flood: a buffer, and the integers that count."""


@dataclass(slots=True)
class Findings:
    """What a hunt found."""

    executions: int = 0
    arcs: int = 0
    outlines: set[str] = field(default_factory=set)
    """What was said, numbers left out."""
    corpus: list[bytes] = field(default_factory=list)
    """Inputs that together reach all that was reached; those given come first."""
    broken: tuple[bytes, str] | None = None
    """An input that made it fail, and how."""
    peak_bytes: int = 0
    """The most memory that one input took."""
    kept_bytes: int = 0
    """What was left of a flood, for a parser of a stream."""


def hunt(
    target: Target, known: Sequence[bytes], *, seconds: float = 0.0, executions: int = 0, seed: int = 0
) -> Findings:
    """Run a parser on what is known, then on changes, for so long (of the processor) and at least so often.

    It ends at the first failure.
    """
    rng = random.Random(f"{target.name}/{seed}")
    coverage = Coverage(target.files)
    found = Findings()
    ends_s = time.process_time() + seconds
    for data in dict.fromkeys((*target.seeds(), *known)):
        if not _reaches_more(target, data, coverage, found):
            return found
    changes = 0
    while changes < executions or time.process_time() < ends_s:
        pool = found.corpus or [b""]
        data = mutated(rng, rng.choice(pool), rng.choice(pool), target.tokens, target.size_max)
        if not _reaches_more(target, data, coverage, found):
            return found
        changes += 1
    found.arcs = len(coverage.arcs)
    _measure(target, rng, found)
    return found


def smallest_set(target: Target, inputs: Sequence[bytes]) -> list[bytes]:
    """Return a few of the inputs that reach all that all of them reach: short ones, greedily."""
    reached: list[tuple[bytes, set[Arc]]] = []
    for data in sorted(inputs, key=len):
        coverage = Coverage(target.files)
        with coverage.watching():
            failure_of(target, data)
        reached.append((data, coverage.arcs))
    missing = set().union(*(arcs for _, arcs in reached))
    chosen = []
    while missing:
        data, arcs = max(reached, key=lambda one: len(one[1] & missing))
        chosen.append(data)
        missing -= arcs
    return sorted(chosen, key=lambda data: (len(data), data))


def failure_of(target: Target, data: bytes, run: Callable[[bytes], object] | None = None) -> str | None:
    """Return how a parser fails on an input; None if it answers, or raises what it may."""
    try:
        (run or target.run)(data)
    except target.typed:
        return None
    except Exception:  # whatever else is raised is what is looked for
        return traceback.format_exc()
    return None


def _outlined(target: Target, data: bytes, found: Findings) -> tuple[str | None, bool]:
    """Return how a parser fails on an input, and whether it says another thing of it than of all before."""
    try:
        said = str(target.run(data))
    except target.typed as error:
        said = f"{type(error).__name__}: {error}"
    except Exception:  # whatever else is raised is what is looked for
        return traceback.format_exc(), True
    outline = _NUMBER.sub("#", said)
    is_new = outline not in found.outlines
    found.outlines.add(outline)
    return None, is_new


def _reaches_more(target: Target, data: bytes, coverage: Coverage, found: Findings) -> bool:
    """Run one input and keep it if it is new; return whether the hunt may go on."""
    before = len(coverage.arcs)
    failure, is_new = _outlined(target, data, found) if target.outlined else (None, True)
    if failure is None and is_new:
        with coverage.watching():
            failure = failure_of(target, data)
    if target.proves is not None:
        failure = failure or failure_of(target, data, target.proves)
    found.executions += 1
    if failure is not None:
        found.broken = (data, failure)
        return False
    if len(coverage.arcs) > before:
        found.corpus.append(data)
    return True


def _measure(target: Target, rng: random.Random, found: Findings) -> None:
    """Run some inputs again and see how much memory they take: tracing it would slow down all of them."""
    pool = found.corpus or [b""]
    inputs = [
        mutated(rng, rng.choice(pool), rng.choice(pool), target.tokens, target.size_max) for _ in range(target.measured)
    ]
    tracemalloc.start()
    try:
        for data in (*pool[: target.measured], *inputs):
            tracemalloc.reset_peak()
            before, _ = tracemalloc.get_traced_memory()
            failure_of(target, data)
            found.peak_bytes = max(found.peak_bytes, tracemalloc.get_traced_memory()[1] - before)
        found.kept_bytes = _kept_of_flood(target, rng, inputs)
    finally:
        tracemalloc.stop()


def _kept_of_flood(target: Target, rng: random.Random, inputs: Sequence[bytes]) -> int:
    if target.stream is None:
        return 0
    pieces = [b"".join(rng.choices(inputs, k=40))[:_PIECE_BYTES] for _ in range(8)]
    parser = target.stream()
    before, _ = tracemalloc.get_traced_memory()
    fed = 0
    while fed < _FLOOD_BYTES:
        piece = rng.choice(pieces) or bytes(_PIECE_BYTES)
        for _ in parser.feed(piece):
            pass
        fed += len(piece)
    return tracemalloc.get_traced_memory()[0] - before
