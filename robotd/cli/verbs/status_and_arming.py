"""``status``, ``arm``, ``disarm``, ``stop``, ``clear``."""

import argparse
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from robotd.cli.connection import connect
from robotd.cli.exit_codes import OK
from robotd.cli.show.metrics_text import exposition
from robotd.cli.show.terminal import err, out, print_json, print_pairs, print_table
from robotd.cli.show.wording import as_json, estimate_in_words
from robotd.cli.verb import Verb
from robotd.contract.answers import HelloResult
from robotd.contract.device_status import DeviceStatus
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import Status
from robotd.contract.metric_families import of_metrics, of_status
from robotd.contract.modes import Mode
from robotd.contract.topics import Topic
from robotd.core.clock import NS_PER_S

if TYPE_CHECKING:
    from robotd.client import Client

_PATIENCE_S = 0.5


def _status(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        if arguments.metrics:
            print(exposition((*of_status(client.status()), *of_metrics(client.metrics()))), end="")
            return OK
        status, hello = client.status(), client.hello()
        pose = _newest_pose(client)
    if arguments.json:
        print_json({**as_json(status), "robotd": hello.robotd, "pose": None if pose is None else as_json(pose)})
    else:
        _print_status(status, hello, pose)
    return OK


def _newest_pose(client: "Client") -> PoseEstimate | None:
    """Return the last estimate that was published, which who subscribes is told at once; None if none comes."""
    with client.subscribe(Topic.POSE) as events:
        event = events.next(_PATIENCE_S)
    return event if isinstance(event, PoseEstimate) else None


def _status_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--metrics", action="store_true", help="print state and counters for Prometheus, as text")


def _print_status(status: Status, hello: HelloResult, pose: PoseEstimate | None) -> None:
    battery = "unknown" if status.battery_v is None else f"{status.battery_v:.1f} V"
    pressed = ", ".join(f"{math.degrees(angle):.0f} deg" for angle in status.bumpers_rad) or "none"
    print_pairs(
        [
            ("mode", f"{status.mode} ({status.reason}){_since(status.time_ns, status.since_ns, ' for {}')}"),
            *([("held", status.held)] if status.held else []),
            ("battery", battery),
            ("bumpers pressed", pressed),
            ("map in use", _map_in_words(status)),
            ("pose", "none yet" if pose is None else estimate_in_words(pose)),
            ("recording to", status.recording or "nothing"),
            ("robotd", f"{hello.robotd}{_since(status.time_ns, status.started_ns, ', up {}')}"),
            *([("next", "robotctl clear, when what is wrong is mended")] if status.mode == Mode.FAULT else []),
        ]
    )
    rows = [
        (device.name, device.link, "armed" if device.armed else "disarmed", ", ".join(device.faults), device.detail)
        for device in status.devices
    ]
    print_table(("device", "link", "motion", "faults", "detail"), rows)
    print_table(("device", "counted on its line since start"), [(one.name, _counted(one)) for one in status.devices])


def _since(now_ns: int, since_ns: int | None, words: str) -> str:
    """Return for how long something has been so, in words; nothing if the daemon does not tell.

    >>> _since(7_500_000_000_000, 0, "for {}")
    'for 2 h 5 min'
    """
    if since_ns is None:
        return ""
    seconds = (now_ns - since_ns) // NS_PER_S
    minutes, hours = seconds // 60, seconds // 3600
    age = f"{hours} h {minutes % 60} min" if hours else f"{minutes} min {seconds % 60} s" if minutes else f"{seconds} s"
    return words.format(age)


def _map_in_words(status: Status) -> str:
    """Return the map in use, and what to do lest it gets lost."""
    if not status.map_unsaved:
        return status.map_name or "none"
    kept = "in memory alone" if status.map_kept_version is None else f"kept as version {status.map_kept_version}"
    return f"{status.map_name}, not saved ({kept}): robotctl map save"


def _counted(device: DeviceStatus) -> str:
    return ", ".join(f"{name} {count}" for name, count in device.counters if count) or "nothing"


def _telling(ask: "Callable[[Client], None]", words: str) -> Callable[[argparse.Namespace], int]:
    """Return a verb that asks for one thing and then says how the robot stands."""

    def run(arguments: argparse.Namespace) -> int:
        with connect(arguments) as client:
            ask(client)
            if arguments.json:
                print_json(as_json(client.status()))
            else:
                out().print(words)
        return OK

    return run


def _arm(client: "Client") -> None:
    client.arm()
    # Arming arms what is there. One who expects it to drive should hear at once what will not.
    absent = [device.name for device in client.status().devices if not device.armed]
    if absent:
        err().print(f"without {', '.join(absent)}: it can only look round where it stands")


VERBS = (
    Verb(
        "status",
        "show the whole robot in one look",
        "robotctl status --json",
        _status,
        _status_arguments,
        asks_daemon=True,
    ),
    Verb(
        "arm",
        "allow motion",
        "robotctl arm",
        _telling(_arm, "armed: it may move"),
        asks_daemon=True,
    ),
    Verb(
        "disarm",
        "stop and forbid motion",
        "robotctl disarm",
        _telling(lambda client: client.disarm(), "disarmed"),
        asks_daemon=True,
    ),
    Verb(
        "stop",
        "stop now, whatever is under way; it needs arm before it moves again",
        "robotctl stop",
        _telling(lambda client: client.stop("stopped at the command line"), "stopped and disarmed"),
        asks_daemon=True,
    ),
    Verb(
        "clear",
        "acknowledge latched faults; the robot stays disarmed",
        "robotctl clear",
        _telling(lambda client: client.clear(), "faults cleared, disarmed"),
        asks_daemon=True,
    ),
)
