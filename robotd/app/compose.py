"""From a configuration to a daemon: which object knows which."""

import random
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotd.config import Config, effective_text
from robotd.core.clock import now_ns
from robotd.core.counted import Counted
from robotd.core.motion_error import MotionError
from robotd.hardware.devices.catalogue import drive, pantilt, rangefinder
from robotd.hardware.devices.dialects import line_format
from robotd.hardware.devices.gaze import Gaze
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.connector import connector, no_line
from robotd.hardware.transport.transport import Connect
from robotd.head.compute import Compute
from robotd.head.head import Head, NotedHead
from robotd.head.settings import HeadSettings
from robotd.maps.archive import Archive
from robotd.maps.packed_content import PackedContent
from robotd.mission.control import Control
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.settings import MissionSettings
from robotd.mission.news import News
from robotd.mission.safety.causes import Causes
from robotd.mission.safety.lease import EndlessLease, Lease
from robotd.mission.supervisor import Supervisor
from robotd.mission.three_devices import Robot
from robotd.mission.whereabouts.carried import Carried, Sure
from robotd.mission.whereabouts.whereabouts import Whereabouts
from robotd.recording.preroll import PrerollJournal


@dataclass(frozen=True, slots=True)
class Daemon:
    """The parts that live as long as the program."""

    robot: Robot
    supervisor: Supervisor
    control: Control
    causes: Causes

    def parts(self) -> dict[str, Coroutine[Any, Any, None]]:
        """Return what must run, by name; all of it until cancelled."""
        devices: dict[str, Coroutine[Any, Any, None]] = {device.name: device.run() for device in self.robot.devices}
        return devices | {"supervisor": self.supervisor.run()}


def serial_connectors(config: Config) -> dict[str, Connect]:
    """Return how to open the three serial lines."""
    lines = {name: (settings.port, line_format(name, settings)) for name, settings in config.devices.items()}
    return {name: no_line if line is None else connector(port, line) for name, (port, line) in lines.items()}


def compose(
    config: Config,
    connects: Mapping[str, Connect],
    head: Head,
    disk: Compute,
    journal: PrerollJournal,
    *,
    leases_end_by_causes: bool = False,
) -> Daemon:
    """Build the daemon on these lines; nothing is opened yet. ``disk`` runs what waits for a disk off the loop.

    With ``leases_end_by_causes`` leases do not run out by themselves, only by :meth:`Causes.repeat`: for replays.
    """
    gaze = Gaze()
    # One stream of nonces per device: who connects first must not change what the others draw.
    wirings = {
        name: Wiring(connect, journal, random.Random(f"{journal.header.session_seed}/{name}"), gaze)
        for name, connect in connects.items()
    }
    robot = Robot(
        drive(config.drive, wirings["drive"]),
        pantilt(config.pantilt, wirings["pantilt"]),
        rangefinder(config.rangefinder, wirings["rangefinder"]),
    )
    counted = Counted()
    # One for all who ask: jobs are counted by name, and a replay counts them in the same order.
    noted = NotedHead(head, lambda name, index: journal.computed(now_ns(), name, index), counted)

    def note_cause(name: str, arguments: dict[str, int]) -> None:
        counted.count("causes_total", cause=name)
        journal.cause(now_ns(), name, arguments)

    settings = mission_settings(config)
    news = News(journal.note)
    supervisor = Supervisor(
        MissionContext(robot, settings, noted, news.publish, whereabouts(settings)),
        news,
        # A recording that ended by itself is none: its file is not written any more.
        lambda: None if journal.path is None or journal.error is not None else str(journal.path),
        battery_min_v=config.drive.battery_min_v,
        note_cause=note_cause,
        make_lease=EndlessLease if leases_end_by_causes else Lease,
        counted=counted,
    )
    # What the files mean is for the head to say.
    archive = Archive(Path(config.maps.dir), PackedContent.read, keep=config.maps.keep)
    control = Control(
        supervisor,
        archive=archive,
        journal=journal,
        head=noted,
        disk=disk,
        recordings_dir=Path(config.recording.dir),
        config_text=effective_text(config),
    )
    causes = Causes(supervisor, supervisor.holding, supervisor.mission.lease_expired, journal)
    return Daemon(robot, supervisor, control, causes)


def whereabouts(settings: MissionSettings) -> Whereabouts:
    """Return the whereabouts of a robot of which nothing is known yet."""
    if not settings.localization.history:
        return Whereabouts()
    sure = Sure(settings.judgement.second_look.doubt_max, settings.localization.conservative)
    return Whereabouts(Carried(MotionError(), sure))


def mission_settings(config: Config) -> MissionSettings:
    """Return what missions need of the configuration."""
    return MissionSettings(
        head_mount=config.pantilt.mount,
        rangefinder=config.rangefinder.calibration,
        sweep=config.sweep,
        driving=config.driving,
        grid=config.grid,
        localization=config.localization,
        judgement=config.judgement,
        planning=config.planning,
    )


def head_settings(config: Config) -> HeadSettings:
    """Return what array work needs of the configuration."""
    return HeadSettings(
        grid=config.grid,
        localization=config.localization,
        judgement=config.judgement,
        error_model=config.error_model,
        planning=config.planning,
    )
