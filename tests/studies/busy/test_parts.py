"""What ``make demo-busy`` is made of, without a look at the clock."""

import os
import select
import subprocess
import sys
from pathlib import Path

from tests.studies.busy.freezing import FREEZES, Freeze, children
from tests.studies.busy.outcome import HEADER, Outcome
from tests.support.spinning import spinning

_SAID = "robotd demo: the laboratory\n  map saved: maps/laboratory/1\n  3 of 4 localized; median error 12 mm\n"
_LOG = """\
ERROR the event loop stood still for 0.31 s: the base was stopped; it was in
WARNING held: this machine was too busy: the loop stood still 0.3 s; log: robotd.log
ERROR the event loop stood still for 0.22 s: nothing was stopped, for the base was not driven; it was in
this machine is busy: simulated time is slowed
"""
_UNTIL_KILLED = """
import sys
from tests.support.spinning import spinning
with spinning(2) as programs:
    print(*programs, flush=True)
    sys.stdin.read()
"""


def test_spinning_programs_have_sessions_of_their_own_and_end_with_the_block() -> None:
    with spinning(3) as programs:
        assert all(program in children(os.getpid()) for program in programs)
        assert {os.getsid(program) for program in programs} == set(programs)
        assert {os.getpriority(os.PRIO_PROCESS, program) for program in programs} == {0}
    assert not set(programs) & set(children(os.getpid()))


def test_spinning_programs_end_with_a_run_that_is_killed() -> None:
    run = subprocess.Popen([sys.executable, "-c", _UNTIL_KILLED], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert run.stdin is not None
    assert run.stdout is not None
    programs = [int(word) for word in run.stdout.readline().split()]
    assert len(programs) == 2
    ends = [os.pidfd_open(program) for program in programs]
    run.kill()
    run.communicate()
    for end in ends:
        os.set_blocking(end, False)
        assert _ended(end)
        os.close(end)


def _ended(process: int) -> bool:
    return bool(select.select([process], [], [], 60.0)[0])


def test_a_demonstration_that_finished_is_read() -> None:
    outcome = Outcome.of(0, 61.2, _SAID, _LOG)
    assert outcome == Outcome(True, 61.2, "3/4", 2, 1, True, "")
    assert outcome.row(8, 15, "") == "| 8 busy | 15 |  | yes | 61 | 3/4 | 2 | 1 | yes |  |"
    assert len(outcome.row(8, 15, "").split("|")) == len(HEADER.splitlines()[0].split("|"))


def test_a_recorded_building_is_read() -> None:
    said = "28 of 30 kept-out stops localized within 0.3 m (93 %; wrong and sure 0)\n"
    assert Outcome.of(0, 1.0, said, "").localized == "28/30"


def test_a_demonstration_that_did_not_finish_gives_its_last_words() -> None:
    outcome = Outcome.of(1, 8.0, "robotd demo\nrobotctl: map stopped: drive: deadman\n\n", "")
    assert not outcome.finished
    assert outcome.reason == "exit code 1: robotctl: map stopped: drive: deadman"
    assert Outcome.of(-9, 8.0, "", "").reason == "exit code -9: it said nothing"
    assert not Outcome.of(0, 8.0, "robotd demo\n", "").finished, "an exit code alone shows nothing"


def test_who_is_to_stand_still_is_found_by_its_command_line(tmp_path: Path) -> None:
    command = [sys.executable, "-c", "import sys; sys.stdin.read()", "robotd.app.daemon"]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, cwd=tmp_path)
    try:
        assert Freeze("client", 0.8).process(os.getpid()) == os.getpid()
        assert Freeze("daemon", 0.5).process(os.getpid()) == process.pid
        assert Freeze("simulator", 0.5).process(os.getpid()) is None
    finally:
        process.communicate()
    assert {str(freeze) for freeze in FREEZES} == {
        "simulator 0.5 s",
        "simulator 2 s",
        "simulator 5 s",
        "daemon 0.5 s",
        "client 0.8 s",
    }
