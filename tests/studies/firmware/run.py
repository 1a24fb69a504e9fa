"""``make firmware-test``: the C of the boards against Python, on random streams and lives; fails at a difference."""

import argparse
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from firmware_proto.common import BoardKind, BoardState, Nack, Result
from firmware_proto.framing import Deframer
from tests.studies.firmware.codec import build_codec, told_by_python
from tests.studies.firmware.compiling import compiler, run, sanitizers
from tests.studies.firmware.peer import Told, build_peer, first_difference, told_by_c
from tests.studies.firmware.peer import told_by_python as done_by_python
from tests.studies.firmware.scripts import random_script
from tests.studies.firmware.streams import random_stream

_LIFE_FRAMES = 500


def main() -> None:
    """Run all of it and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10_000, help="of each part (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the first stream (default: %(default)s)")
    arguments = parser.parse_args()
    if compiler() is None:
        sys.exit("firmware: there is no C compiler")
    print(f"firmware: {compiler()}, every warning an error, {' '.join(sanitizers()[:1]) or 'no sanitizers'}")
    with tempfile.TemporaryDirectory() as directory:
        differences = _codec(Path(directory), arguments.seed, arguments.frames)
        differences += _boards(Path(directory), arguments.seed, arguments.frames)
    sys.exit(bool(differences))


def _codec(directory: Path, seed: int, frames: int) -> int:
    program, stream = build_codec(directory), random_stream(seed, frames)
    started_s = time.perf_counter()
    in_c = run(program, stream)
    took_s = time.perf_counter() - started_s
    in_python = told_by_python(stream)
    lines = [line for line in in_c.splitlines() if not line.startswith(">")]
    refused = sum(line.endswith(("UNKNOWN_TYPE", "BAD_LENGTH")) for line in lines)
    crc, cobs, length = lines[-1].split()
    differences = sum(one != other for one, other in zip(in_c.splitlines(), in_python.splitlines(), strict=False))
    differences += abs(in_c.count("\n") - in_python.count("\n"))
    print(
        f"codec: {frames} frames sent, a third of them damaged, {len(stream)} bytes; "
        f"{len(lines) - 1} found, {refused} of them refused; "
        f"errors: {crc} CRC, {cobs} COBS, {length} length; {differences} differences; C took {took_s:.2f} s"
    )
    return differences


def _boards(directory: Path, seed: int, frames: int) -> int:
    program = build_peer(directory)
    return sum(_lives(program, kind, seed, -(-frames // _LIFE_FRAMES)) for kind in BoardKind)


def _lives(program: Path, kind: BoardKind, seed: int, count: int) -> int:
    """Let boards of one kind live this many lives; return how many differ."""
    told: list[Told] = []
    different = 0
    for life in range(seed, seed + count):
        script = random_script(kind, life, _LIFE_FRAMES)
        in_c = told_by_c(program, kind, script)
        told += in_c
        difference = first_difference(script, in_c, done_by_python(kind, script))
        different += difference is not None
        if difference is not None:
            print(f"{kind.name.lower()}, life {life}: {difference}", file=sys.stderr)
    about = f"{count} lives of {_LIFE_FRAMES} frames heard, {_summary(told)}; {different} lives differ"
    print(f"{kind.name.lower()}: {about}")
    return different


def _summary(told: list[Told]) -> str:
    frames = Deframer().feed(b"".join(bytes.fromhex(sent) for _, sent, _ in told))
    states = Counter(BoardState(int(end.split()[1])).name for _, _, end in told)
    refusals = Counter(Result(frame.payload[0]).name for frame in frames if frame.type == Nack.TYPE)
    visited = ", ".join(f"{count} {name}" for name, count in sorted(states.items()))
    refused = ", ".join(f"{count} {name}" for name, count in sorted(refusals.items()))
    return f"{len(frames)} said; refused: {refused}; steps in {visited}"


if __name__ == "__main__":
    main()
