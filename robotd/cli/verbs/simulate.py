"""``sim`` and ``fake``: simulated boards on pseudo-terminals."""

import argparse

from robotd.cli.inputs import RECORDING_HELP, input_argument
from robotd.cli.outputs import LINKS, MADE_CONFIG, TRUTH_LINES, output_argument
from robotd.cli.quantities import whole
from robotd.cli.verb import Verb
from robotd.cli.wheels import odometry_argument
from robotd.hardware.devices.dialects import DIALECTS
from robotd.sim.buildings.world import world_names
from robotd.sim.faults.fault_words import FAULTS, meaning_of

_WORLD = "laboratory"
_OWN = "board"
FIRMWARE = ("python", "c")
"""The words of :class:`robotd.sim.emulators.catalogue.Firmware`, which takes long to load; a test compares them."""


def _sim(arguments: argparse.Namespace) -> int:
    from robotd.cli.simulated import simulate  # noqa: PLC0415  # the simulation itself

    return simulate(arguments, _WORLD)


def _fake(arguments: argparse.Namespace) -> int:
    from robotd.cli.simulated import fake  # noqa: PLC0415  # as above

    return fake(arguments)


def _sim_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "world",
        nargs="?",
        metavar="WORLD",
        help=f"{', '.join(world_names())}, a file of one, or a map's yaml (default: {_WORLD})",
    )
    parser.add_argument(
        "--explore",
        action="store_true",
        help="no boards: let whole daemons explore it in virtual time, and say how well (default: all built-in worlds)",
    )
    parser.add_argument("--seeds", type=whole(1), default=3, metavar="N", help="robots that explore each (default: 3)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="same seed, same noise (default: 1)")
    odometry_argument(parser)
    for device, table in DIALECTS.items():
        parser.add_argument(
            f"--{device}", choices=list(table), default=_OWN, help=f"what the {device} speaks (default: {_OWN})"
        )
    parser.add_argument(
        "--boards",
        choices=FIRMWARE,
        default=FIRMWARE[0],
        help="what our own boards run: Python that does the same, or the firmware in C (default: python)",
    )
    output_argument(parser, "--truth", TRUTH_LINES, "note in it where the robot really came to rest")
    _lines_arguments(parser)
    words = "\n".join(f"  {word:10}{meaning_of(word)}" for word in FAULTS)
    faults = parser.add_argument_group(
        "faults",
        "DEVICE:FAULT@START[+DURATION],... lets a fault begin on the cable of\n"
        "drive, pantilt, rangefinder or all of them, START seconds after the\n"
        f"simulation did; without a DURATION it lasts to the end. The faults:\n\n{words}",
    )
    faults.add_argument(
        "--faults", metavar="PLAN", help="what goes wrong: drive:unplug@20s+3s,rangefinder:garbage@35s+2s"
    )


def _fake_arguments(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "file", RECORDING_HELP, metavar="RECORDING")
    _lines_arguments(parser)


def _lines_arguments(parser: argparse.ArgumentParser) -> None:
    output_argument(parser, "--links", LINKS, "keep links drive, pantilt and rangefinder there")
    output_argument(parser, "--write-config", MADE_CONFIG, "write a robotd.toml for these devices")


VERBS = (
    Verb(
        "sim",
        "simulate a robot in a room: its three boards, on pseudo-terminals",
        "robotctl sim laboratory --write-config lab/robotd.toml",
        _sim,
        _sim_arguments,
    ),
    Verb(
        "fake",
        "answer as the recorded boards did, on pseudo-terminals: run a fresh daemon on them",
        "robotctl fake a.mcap --write-config again/robotd.toml",
        _fake,
        _fake_arguments,
    ),
)
