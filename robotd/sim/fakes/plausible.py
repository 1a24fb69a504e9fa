"""What a board in good health would say, where a recording does not say it."""

import zlib
from dataclasses import replace

from firmware_proto.common import Ack, Arm, BoardState, Configure, ConfigureReply, Fault, Kill, Result
from firmware_proto.pantilt_messages import Aim, AimReport, Motion
from firmware_proto.rangefinder_messages import Shoot, Shot, ShotStatus
from firmware_proto.schema import Message


def plausible_answer(request: Message, now_us: int) -> Message | Result:
    """Return the answer to a request of which nothing is recorded: done; but no reading is made up."""
    match request:
        case Configure():
            return ConfigureReply(Result.OK, zlib.crc32(request.to_payload()))
        case Shoot():
            return Shot(now_us, 0, 0, ShotStatus.NOT_MEASURED)
    return Result.OK


def recorded_answer(answer: Message, came_us: int) -> Message | Result:
    """Return a recorded answer as it is to be given to a request that came at ``came_us``."""
    match answer:
        case Ack():
            return Result(answer.result)
        case Shot():
            return replace(answer, board_us=came_us)
    return answer


def aimed(aim: Aim, seq: int, now_us: int, motion: Motion) -> AimReport:
    """Return the report of a head that is there, or turns there."""
    return AimReport(now_us, aim.pan_tenth_mrad, aim.tilt_tenth_mrad, seq, motion)


def state_after(request: Message) -> tuple[BoardState, Fault]:
    """Return the state to which one of the requests leads that every board knows."""
    match request:
        case Arm():
            return BoardState.ARMED, Fault.NONE
        case Kill():
            return BoardState.FAULT, Fault.KILLED
    return BoardState.CONFIGURED, Fault.NONE
