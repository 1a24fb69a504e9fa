"""A fake head and a fake base move as the recorded ones did, for a host that asks as the recorded one or otherwise."""

from firmware_proto.common import (
    Ack,
    Arm,
    BoardKind,
    Result,
)
from firmware_proto.drive_messages import OdometryReport, SetVelocity
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Limits, Motion, ReadAim, ReadLimits
from tests.unit.sim.fakes.tapes import (
    Host,
    Tape,
    aim_report,
    drive_tape,
    head_tape,
)


def test_motion_done_carries_the_seq_of_the_living_aim() -> None:
    board = head_tape().board()
    host = Host(board, BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.wait(10)
    for number, pan in enumerate((100, 200, 300)):
        host.ask(Aim(pan, 0, 900))
        seq = host.seq
        reports = [message for message in host.wait(200) if isinstance(message, AimReport)]
        assert (reports[0].moving, reports[0].aim_seq) == (Motion.TURNING, seq)
        assert {(r.moving, r.aim_seq, r.pan_tenth_mrad) for r in reports[1:]} == {(Motion.DONE, seq, pan + number)}
        (readback,) = host.ask(ReadAim())
        assert readback == AimReadback(host.now_us, pan + number, 0, seq, Motion.DONE)
    assert board.mismatches == []
    assert board.finished


def test_whoever_asks_during_a_motion_hears_of_this_motion() -> None:
    tape = Tape("pantilt").opens().says(60, aim_report(0, 0, Motion.HALTED)).arms(600)
    tape.asks(1000, Aim(100, 0, 900), 0).says(1001, aim_report(0, 0, Motion.HALTED))  # sent before the Aim came
    tape.says(1002, Ack(Result.OK), 0, to=Aim).says(1050, aim_report(100, 0, Motion.DONE))
    host = Host(tape.board(), BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.wait(100)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 0, 0, 0, Motion.HALTED)]
    host.ask(Aim(100, 0, 900))
    host.wait(5)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 100, 0, 0, Motion.TURNING)]
    host.wait(50)
    assert host.ask(ReadAim()) == [AimReadback(host.now_us, 100, 0, 0, Motion.DONE)]


def test_limits_are_answered_whenever_they_are_asked_for() -> None:
    host = Host(head_tape().board(), BoardKind.PANTILT)
    host.open()
    for _ in range(3):
        assert host.ask(ReadLimits()) == [Limits(-9, 9, -5, 5)]


def test_the_base_stands_until_it_is_set_in_motion_and_then_goes_where_it_went() -> None:
    board = drive_tape().board()
    host = Host(board, BoardKind.DRIVE)
    host.open()
    host.ask(Arm())
    counts: list[int] = []

    def listen(ms: float) -> None:
        counts.extend(message.translate_counts for message in host.wait(ms) if isinstance(message, OdometryReport))

    for _ in range(2):
        listen(500)
        assert set(counts[-5:]) == {counts[-1]}, "it stands"
        assert host.ask(SetVelocity(0, 0, 400)) == [Ack(Result.OK)], "to stand is no motion"
        listen(100)
        assert host.ask(SetVelocity(300, 0, 400)) == [Ack(Result.OK)]
        listen(60)
        assert host.ask(SetVelocity(222, 0, 400)) == [Ack(Result.OK)], "how it is renewed does not matter"
        listen(45)
        host.ask(SetVelocity(0, 0, 400))
        listen(100)
    assert list(dict.fromkeys(counts)) == [10, 20, 30, 40, 50, 60, 70]
    assert board.mismatches == []
    assert board.finished


def test_a_deviating_request_is_told_and_answered_as_recorded() -> None:
    board = head_tape().board()
    host = Host(board, BoardKind.PANTILT)
    host.open()
    host.ask(Arm())
    host.ask(Aim(111, 0, 900))
    (difference,) = board.mismatches
    expected, got = str(Aim(100, 0, 900)), str(Aim(111, 0, 900))
    assert str(difference) == f"1.000000 s pantilt: expected {expected}, got {got}"
    assert [m.pan_tenth_mrad for m in host.wait(95) if isinstance(m, AimReport)][-1] == 100
