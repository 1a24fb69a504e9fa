"""``calibrate odometry``, ``heading``, ``head`` and ``range``: the robot finds its own constants."""

import argparse
import math
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from robotd import config
from robotd.calibration.found import Calibration, Constants, Found, Procedure
from robotd.calibration.head_zero import calibrate_head
from robotd.calibration.range_bias import calibrate_range, leg_for
from robotd.calibration.wheel_scales import FULL_ROUNDS, calibrate_heading, calibrate_odometry
from robotd.cli.connection import connect
from robotd.cli.exit_codes import OK
from robotd.cli.guide import constants_of, guided
from robotd.cli.motion import stopped
from robotd.cli.outputs import PNG, output_argument, write
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import between
from robotd.cli.show.half_blocks import can_draw_blocks
from robotd.cli.show.strips import strip
from robotd.cli.show.terminal import err, out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.contract.modes import Mode
from robotd.core.errors import ConfigError, MissionError, RobotdError
from robotd.toml.edit import with_values

_DIGITS = 7
_SHOWN = {"m": ("mm", 1000.0), "rad": ("deg", 180.0 / math.pi)}
Make = Callable[[Constants, argparse.Namespace], Procedure]
"""Makes a calibration of what the daemon believes and of the command line."""


def _calibrating(
    what: str, make: Make, motion: Callable[[argparse.Namespace], str]
) -> Callable[[argparse.Namespace], int]:
    """Return a verb that carries a calibration out, shows what came of it, and writes it down if that is wanted."""

    def run(arguments: argparse.Namespace) -> int:
        if arguments.png is not None:
            require_plots("--png")
        file = arguments.config or config.default_path()
        if arguments.yes or arguments.config is not None:
            config.load(file)  # before it drives for minutes: what was found must have a place
        with connect(arguments) as client:
            if client.status().mode != Mode.IDLE:
                raise MissionError("the robot must be armed and idle first: robotctl arm")
            if not _agreed(arguments, f"{motion(arguments)}; nothing but its bumpers sees what is in the way. Go on?"):
                return OK
            now = constants_of(config.loads(client.config()))
            try:
                calibration = guided(client, make(now, arguments), err().print)
            except KeyboardInterrupt:
                return stopped(client)
        _show(what, calibration, arguments)
        _keep(calibration, arguments)
        return OK

    return run


def _agreed(arguments: argparse.Namespace, question: str) -> bool:
    """Return whether somebody says yes; ``--yes`` does, and who cannot be asked does not.

    Raises:
        RobotdError: there is nobody to ask.
    """
    if arguments.yes:
        return True
    if not sys.stdin.isatty():
        raise RobotdError(f"{question} Say so with --yes where nobody can be asked")
    err().print(f"{question} [y/N] ", end="")
    return sys.stdin.readline().strip().lower() in {"y", "yes"}


def _show(what: str, calibration: Calibration, arguments: argparse.Namespace) -> None:
    if arguments.png is not None:
        from robotd.cli.pictures.residuals import draw_residuals  # noqa: PLC0415  # only here is the extra needed

        draw_residuals(arguments.png, f"calibrate {what}: what is left", calibration.residuals)
    if arguments.json:
        print_json([asdict(one) for one in calibration.found])
        return
    print_table(("constant", "was", "is", "give or take", "unit"), [_row(one) for one in calibration.found])
    for one in calibration.residuals:
        unit, factor = _SHOWN[one.unit]
        # Where nothing is left over, the bars still need a scale.
        reach = max(float(abs(one.values).max()), 1e-9)
        bars = strip(one.values, reach, blocks=can_draw_blocks(out().encoding))
        out().print(f"{one.name}: -{factor * reach:.2f} |{bars}| {factor * reach:.2f} {unit}")


def _row(one: Found) -> tuple[str, str, str, str, str]:
    name = f"{one.section}.{one.key}"
    return name, f"{one.before:.{_DIGITS}g}", f"{one.value:.{_DIGITS}g}", f"{one.error:.2g}", one.unit


def _keep(calibration: Calibration, arguments: argparse.Namespace) -> None:
    """Write what was found into the configuration, if that is wanted; else say what to write."""
    file: Path = arguments.config or config.default_path()
    values: dict[str, dict[str, object]] = {}
    for one in calibration.found:
        values.setdefault(one.section, {})[one.key] = float(f"{one.value:.{_DIGITS}g}")
    if arguments.json and not arguments.yes:
        return
    if not arguments.json and not _agreed(arguments, f"Write that into {file}?"):
        return
    try:
        text = file.read_text(encoding="utf-8")
        config.load(file)
        # The text is changed and not written again: what its owner wrote beside the values stays.
        changed = with_values(text, values, "before it was calibrated")
        # Before it is written: with a file that is refused, no daemon would start any more.
        config.loads(changed, str(file))
    except UnicodeDecodeError as error:
        raise ConfigError("not UTF-8", file=str(file)) from error
    write(file, changed.encode())
    err().print(f"written into {file}, the old lines as comments; the daemon takes it from its next start on")


def _common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--yes", action="store_true", help="ask nothing: go on, and write what was found")
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="what to write it into (default: $ROBOTD_CONFIG, or /etc/robotd/robotd.toml)",
    )
    output_argument(parser, "--png", PNG, "draw what the constants leave unexplained, too")


def _straight(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--distance",
        type=between(0.3, 5.0, "m"),
        default=1.5,
        metavar="M",
        help="how far ahead, and back again, 0.3 to 5 [m] (default: 1.5)",
    )
    _common(parser)


def _wall(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--wall",
        type=between(0.5, 5.0, "m"),
        required=True,
        metavar="M",
        help="how far the wall ahead is from the pan axis, square to it, by your tape [m]",
    )
    _common(parser)


def _there_and_back(arguments: argparse.Namespace) -> str:
    return f"it drives {arguments.distance:g} m ahead and back, twice"


def _before_the_wall(arguments: argparse.Namespace) -> str:
    leg_m = leg_for(arguments.wall)
    return f"facing a flat wall, it drives {abs(leg_m):.2f} m {'nearer' if leg_m > 0.0 else 'away'}"


_EXAMPLES = {
    "odometry": "robotctl calibrate odometry --distance 2",
    "heading": "robotctl calibrate heading --yes",
    "head": "robotctl calibrate head --png head.png",
    "range": "robotctl calibrate range --wall 1.8",
}


def _verb(
    what: str,
    summary: str,
    make: Make,
    motion: Callable[[argparse.Namespace], str],
    arguments: Callable[[argparse.ArgumentParser], None],
) -> Verb:
    return Verb(
        f"calibrate {what}", summary, _EXAMPLES[what], _calibrating(what, make, motion), arguments, asks_daemon=True
    )


VERBS = (
    _verb(
        "odometry",
        "find the wheels' counts per metre and per radian: straight out and back, turns there and back",
        lambda now, arguments: calibrate_odometry(now, arguments.distance),
        lambda arguments: f"{_there_and_back(arguments)}, and turns a quarter each way",
        _straight,
    ),
    _verb(
        "heading",
        f"find the counts per radian to some hundredths of a percent, by {FULL_ROUNDS} rounds each way",
        lambda now, _: calibrate_heading(now),
        lambda _: f"it turns {FULL_ROUNDS} times round, each way",
        _common,
    ),
    _verb(
        "head",
        "find where the head's zero is, and the play of its gears",
        lambda now, arguments: calibrate_head(now, arguments.distance),
        _there_and_back,
        _straight,
    ),
    _verb(
        "range",
        "find what must be added to every range, before a flat wall at two distances",
        lambda now, arguments: calibrate_range(now, arguments.wall),
        _before_the_wall,
        _wall,
    ),
)
