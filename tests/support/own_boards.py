"""The boards of a simulated robot that speak our own protocol, to look inside."""

from firmware_proto.common import Kill
from firmware_proto.framing import RawFrame, encode_frame
from robotd.core.errors import ConfigError
from robotd.hardware.wire.board import EMERGENCY_SEQ
from robotd.sim.boards.emulated_board import Board
from robotd.sim.hosting.host import OwnBoard
from robotd.sim.robot import EmulatedRobot

KILL_BYTES = encode_frame(RawFrame(Kill.TYPE, EMERGENCY_SEQ, b""))
"""What a switch or another host may say to a board; the daemon itself never kills, it stops."""


def board_of(robot: EmulatedRobot, device: str) -> OwnBoard:
    """Return a board that speaks our own protocol, whatever its firmware is written in.

    Raises:
        ConfigError: the device speaks another dialect.
    """
    board = robot.boards[device]
    if not isinstance(board, OwnBoard):
        raise ConfigError("the device speaks its maker's protocol", key=device)
    return board


def own_board(robot: EmulatedRobot, device: str) -> Board:
    """Return a board that speaks our own protocol, in Python: for tests that look inside.

    Raises:
        ConfigError: the device speaks another dialect.
    """
    board = robot.boards[device]
    if not isinstance(board, Board):
        raise ConfigError("the device speaks its maker's protocol", key=device)
    return board
