"""Hardware in the loop: boards that answer a living daemon as the recorded boards once answered theirs.

A fake board speaks the protocol for itself (handshake, sequence numbers, repeats, clock) and takes the contents from a
recording, in the recorded order: the same requests get the same readings, odometry and results, whenever they
are made. While it waits for the daemon it repeats its last telemetry. All times are its own: telemetry is
stamped when it is said, a shot when it was asked for.
"""

import logging
from dataclasses import replace

from firmware_proto.common import (
    DICTIONARY_CHUNK,
    BoardKind,
    BoardState,
    BoardStatus,
    Configure,
    Fault,
    Hello,
    Identify,
    IdentifyReply,
    Kill,
    Ping,
    Pong,
    Result,
    Stop,
)
from firmware_proto.dictionary import REQUEST_END, requests_for
from firmware_proto.drive_messages import DriveReport, OdometryReport, SetVelocity
from firmware_proto.framing import Deframer, RawFrame
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Motion, ReadAim, ReadLimits
from firmware_proto.rules import RULES
from firmware_proto.schema import Message, payload_size
from robotd.core.errors import RecordingError
from robotd.recording.comparison import NOTHING, Difference
from robotd.recording.reader import Recording
from robotd.sim.boards.board_outbox import BoardOutbox
from robotd.sim.fakes.plausible import aimed, plausible_answer, recorded_answer, state_after
from robotd.sim.fakes.script import BOOKKEEPING, Said, ScriptedRequest, is_standstill, read_script, starts_motion
from robotd.sim.fakes.walk import Meeting, Walk

_NS_PER_US = 1000
_MADE_LIVE = (Configure, Stop, Kill, SetVelocity)
"""Requests whose answers hold nothing recorded."""

_log = logging.getLogger(__name__)


def fake_boards(recording: Recording) -> dict[str, "FakeBoard"]:
    """Return a fake for each board of a recorded robot, by device name.

    Raises:
        RecordingError: the recording holds no serial line of a device that we know.
    """
    devices = [kind.name.lower() for kind in BoardKind]
    if not set(devices) & set(recording.devices):
        raise RecordingError(f"the recording holds no bytes of {', '.join(devices)}")
    return {device: FakeBoard(recording, device) for device in devices}


class FakeBoard:
    """One recorded board; the same sans-I/O interface as an emulated one."""

    def __init__(self, recording: Recording, device: str) -> None:
        """Take the part of ``device``.

        Raises:
            KeyError: there is no such kind of board.
        """
        self.mismatches: list[Difference] = []
        """Requests that were not the recorded ones; times are the recording's."""
        self._device = device
        self._script = read_script(recording.entries, device)
        self._requests = requests_for(self._script.kind)
        self._deframer = Deframer()
        self._outbox = BoardOutbox()
        self._hello: Hello | None = None
        self._session = 0
        self._now_us = 0
        self._begin(0)

    def _begin(self, session: int) -> None:
        self._session = session
        self._walk = Walk(self._script.sessions[session].steps, self._now_us)
        self._period_us: int | None = None
        self._repeat_us: int | None = None
        self._last: dict[type[Message], Message] = {}
        self._open: dict[int, tuple[Message, int, int]] = {}
        """Requests whose answers are still to come, by step: the request, its seq, when it came."""
        self._aim_seqs: dict[int, int] = {}
        """Our seq of each Aim, by the recorded one."""
        self._last_change: Message | None = None
        self._moving = False
        self._improvised: tuple[BoardState, Fault] | None = None
        """The state to show after a request that is not in the script."""

    # What the wire sees

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host, at the board's time."""
        self.advance(now_us)
        for frame in self._deframer.feed(data):
            self._take(frame)

    def advance(self, now_us: int) -> None:
        """Let time pass, and say what falls due."""
        self._now_us = max(now_us, self._now_us)
        for said in self._walk.take_due(self._now_us):
            self._say(said)
        if self._repeat_us is not None and self._repeat_us <= self._now_us and self._is_waiting:
            self._put_off_repeating()
            for message in tuple(self._last.values()):
                self._tell(message)

    def take_output(self) -> bytes:
        """Return, once, the bytes that the board has for the host."""
        return self._outbox.take()

    @property
    def next_event_us(self) -> int | None:
        """When :meth:`advance` must be called at the latest; None while nothing is to come."""
        return self._repeat_us if self._is_waiting else self._walk.due_us

    @property
    def finished(self) -> bool:
        """Whether the host has come to the end of the recording."""
        return self._session == len(self._script.sessions) - 1 and self._walk.finished

    @property
    def _is_waiting(self) -> bool:
        """Whether it is the host's turn. At the end of a session that was followed by another the board is silent."""
        is_over = self._walk.expected is None and self._session < len(self._script.sessions) - 1
        return self._walk.due_us is None and not is_over

    # Requests

    def _take(self, frame: RawFrame) -> None:
        layout = self._requests.get(frame.type)
        if layout is None or payload_size(layout) != len(frame.payload):
            if frame.type < REQUEST_END:  # or a line that is looped back would answer itself
                self._outbox.reply(frame.type, frame.seq, Result.UNKNOWN_TYPE if layout is None else Result.BAD_LENGTH)
            return
        request = layout.from_payload(frame.payload)
        if RULES[layout].deduplicated and self._outbox.repeat(frame.type, frame.seq):
            return
        if isinstance(request, Hello):
            self._open_session(request)
        answer = self._at_once(request)
        if answer is None:
            self._change(request, frame.seq)
        else:
            self._outbox.reply(frame.type, frame.seq, answer)

    def _open_session(self, hello: Hello) -> None:
        """Go on to the session that followed, or, for a fresh daemon, back to the beginning."""
        self._outbox.new_session()
        if self._hello is not None and self._hello.nonce == hello.nonce:  # said again: its answer was lost
            return
        goes_on = self._hello is not None and self._walk.finished and self._session + 1 < len(self._script.sessions)
        self._hello = hello
        self._begin(self._session + 1 if goes_on else 0)

    def _at_once(self, request: Message) -> Message | Result | None:
        """Answer what changes nothing; None if the request changes something."""
        match request:
            case Hello():
                return self._script.identity(self._session, request.nonce)
            case Ping():
                return Pong(request.host_us, self._now_us)
            case Stop() | Kill():
                return Result.OK if self._hello is None else None
        return Result.WRONG_STATE if self._hello is None else self._in_session(request)

    def _in_session(self, request: Message) -> Message | Result | None:
        match request:
            case Identify():
                dictionary = self._script.dictionary(self._session)
                return IdentifyReply(request.offset, dictionary[request.offset :][:DICTIONARY_CHUNK])
            case ReadAim():
                return self._readback()
            case ReadLimits():
                return self._script.limits or Result.WRONG_STATE
            case SetVelocity() if not starts_motion(request, moving=self._moving):
                self._moving = self._moving and not is_standstill(request)
                return Result.OK
        return None

    def _change(self, request: Message, seq: int) -> None:
        """Meet the script, or improvise."""
        if isinstance(request, Configure):
            self._outbox.telling = True
            self._period_us = request.telemetry_ms * 1000
            self._put_off_repeating()
        self._moving = starts_motion(request, moving=self._moving) or (self._moving and not is_standstill(request))
        # Stops are said until they are obeyed, and the script has one step for all of them.
        is_volley = isinstance(request, Stop | Kill) and request == self._last_change
        self._last_change = request
        expected = self._walk.expected
        meeting = None if is_volley else self._walk.meet(request, self._now_us)
        if meeting is not None:
            self._follow(meeting, request, seq)
            return
        if expected is not None and not isinstance(request, Stop | Kill):  # which may come at any time
            self._differs(expected, str(request))
        self._improvise(request, seq)

    def _follow(self, meeting: Meeting, request: Message, seq: int) -> None:
        for asked in meeting.skipped:
            self._differs(asked, NOTHING)
        if not meeting.agrees(request):
            self._differs(meeting.asked, str(request))
        for said in meeting.caught_up:
            self._say(said)
        self._improvised = None
        if isinstance(request, Aim):
            self._aim_seqs[meeting.asked.seq] = seq
            # Until the next report, anyone who asks must not hear what became of the Aim before.
            self._last[AimReport] = aimed(request, seq, self._now_us, Motion.TURNING)
        if meeting.asked.answered and not isinstance(request, _MADE_LIVE):
            self._open[meeting.place] = (request, seq, self._now_us)
            self._outbox.remember(request.TYPE, seq, b"")  # a repeat waits for the same answer
        else:
            self._reply(request, seq, plausible_answer(request, self._now_us))

    def _improvise(self, request: Message, seq: int) -> None:
        """Answer what the recorded host never asked here, as a board in good health would."""
        self._reply(request, seq, plausible_answer(request, self._now_us))
        if isinstance(request, Aim):
            self._tell(aimed(request, seq, self._now_us, Motion.DONE))
        elif isinstance(request, (Configure, *BOOKKEEPING)):
            before, self._improvised = self._improvised, state_after(request)
            if BoardStatus in self._last and self._improvised != before:
                self._tell(self._last[BoardStatus])

    def _reply(self, request: Message, seq: int, outcome: Message | Result) -> None:
        wire = self._outbox.reply(request.TYPE, seq, outcome)
        if RULES[type(request)].deduplicated:
            self._outbox.remember(request.TYPE, seq, wire)

    def _differs(self, expected: ScriptedRequest, got: str) -> None:
        difference = Difference(expected.time_us * _NS_PER_US, self._device, str(expected.request), got)
        self.mismatches.append(difference)
        _log.warning("%s", difference)

    # What the board says

    def _say(self, said: Said) -> None:
        message = said.message
        if isinstance(message, AimReport):
            message = replace(message, aim_seq=self._aim_seqs.get(message.aim_seq, message.aim_seq))
        if said.answers is None:
            self._tell(message)
        elif said.answers in self._open:
            request, seq, came_us = self._open.pop(said.answers)
            self._reply(request, seq, recorded_answer(message, came_us))

    def _tell(self, message: Message) -> None:
        """Send telemetry as of now."""
        match message:
            case BoardStatus():
                state, faults = self._improvised or (message.state, message.faults)
                message = replace(message, board_us=self._now_us, state=state, faults=faults)
            case OdometryReport() | DriveReport() | AimReport():
                message = replace(message, board_us=self._now_us)
        if not (isinstance(message, AimReport) and self._is_aiming):
            self._last[type(message)] = message
        self._outbox.tell(message)
        self._put_off_repeating()

    @property
    def _is_aiming(self) -> bool:
        """Whether an Aim is not acknowledged yet: reports that come before its Ack are of the time before it."""
        return any(isinstance(request, Aim) for request, _, _ in self._open.values())

    def _put_off_repeating(self) -> None:
        if self._period_us is not None:
            self._repeat_us = self._now_us + self._period_us

    def _readback(self) -> Message | Result:
        report = self._last.get(AimReport)
        if not isinstance(report, AimReport):
            return Result.WRONG_STATE
        return AimReadback(self._now_us, report.pan_tenth_mrad, report.tilt_tenth_mrad, report.aim_seq, report.moving)
