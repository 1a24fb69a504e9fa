"""What a daemon needs of this machine, looked at one by one; each finding ends in its remedy."""

import grp
import os
import shutil
import stat
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from robotd.children.landlock import version
from robotd.cli.connection import require_daemon
from robotd.config import Config
from robotd.core.errors import RobotdError
from robotd.hardware.transport.holder import holder_of

_FREE_BYTES = 200_000_000
"""A day of maps, or an hour of recordings."""
_BUILT_AFTER_S = 1_735_689_600.0
"""The first of January 2025: a clock before that was never set."""
_MEDDLERS = {
    "ModemManager": "it tries serial ports for modems; use the udev rules, or systemctl disable --now ModemManager",
    "brltty": "it takes serial ports for Braille displays; use the udev rules, or systemctl disable --now brltty",
}


@dataclass(frozen=True, slots=True)
class Check:
    """One thing looked at."""

    what: str
    found: str
    remedy: str = ""
    """What to do about it; empty if it is well."""

    @property
    def is_well(self) -> bool:
        """Whether nothing is to be done."""
        return not self.remedy

    def __str__(self) -> str:
        """Say it in a line that ends in what to do."""
        return self.found if self.is_well else f"{self.found}: {self.remedy}"


def checks(config: Config) -> Iterator[Check]:
    """Look at everything that a daemon with this configuration needs."""
    daemon = _daemon(Path(config.server.runtime_dir))
    for device, settings in config.devices.items():
        yield _port(device, settings.port, is_served=daemon.is_well)
    yield from _meddlers()
    yield _room("maps", Path(config.maps.dir))
    yield _room("recordings", Path(config.recording.dir))
    yield _clock()
    yield _confinement()
    yield daemon


def _port(device: str, port: str, *, is_served: bool) -> Check:
    if not port.startswith("/"):
        return Check(device, f"{port}: not on this machine, so nothing was looked at")
    try:
        status = Path(port).stat()
    except OSError as error:
        remedy = "plug it in, or name another one: robotctl config init lists what is plugged in"
        return Check(device, f"{port}: {(error.strerror or str(error)).lower()}", remedy)
    if not stat.S_ISCHR(status.st_mode):
        return Check(device, f"{port}: no serial port", f"name one in {device}.port")
    if not os.access(port, os.R_OK | os.W_OK):
        return Check(device, f"{port}: you may not use it", _permission(status.st_gid))
    holder = holder_of(port)
    if holder is not None and not is_served:
        return Check(device, f"{port}: held by {holder}", "end that program, then start the daemon")
    return Check(device, f"{port}: there{f', held by {holder}' if holder else ', and free'}")


def _permission(group_id: int) -> str:
    try:
        group = grp.getgrgid(group_id).gr_name
    except KeyError:
        return "run as the user of the daemon"
    return f"sudo usermod -aG {group} $USER, then log in again"


def _meddlers() -> Iterator[Check]:
    running = {_name(process) for process in Path("/proc").glob("[0-9]*/comm")}
    for program, remedy in _MEDDLERS.items():
        if program in running:
            yield Check(program, "running", remedy)


def _name(comm: Path) -> str:
    try:
        return comm.read_text().strip()
    except OSError:  # it ended meanwhile
        return ""


def _room(what: str, directory: Path) -> Check:
    there = next((path for path in (directory, *directory.absolute().parents) if path.is_dir()), Path("/"))
    free = shutil.disk_usage(there).free
    found = f"{directory}: {free / 1e9:.1f} GB free"
    if not os.access(there, os.W_OK):
        return Check(what, f"{directory}: you may not write there", "run as the user of the daemon")
    return (
        Check(what, found)
        if free >= _FREE_BYTES
        else Check(what, found, "make room: robotctl map list, and old recordings")
    )


def _clock() -> Check:
    now_s = time.time()
    said = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(now_s))
    remedy = "" if now_s > _BUILT_AFTER_S else "set it, or let it be set: timedatectl set-ntp true"
    return Check("clock", said, remedy)


def _confinement() -> Check:
    what = "children"
    try:
        return Check(what, f"the kernel keeps them from all files but their own (Landlock, version {version()})")
    except OSError as error:  # nothing to be done for it in an afternoon, and the daemon serves without
        return Check(what, f"not kept from files of their user: no Landlock ({error.strerror}; Linux 5.13 has it)")


def _daemon(directory: Path) -> Check:
    try:
        require_daemon(directory)
    except RobotdError as error:
        return Check("daemon", str(error).partition(": start")[0], "robotd --config FILE, or systemctl start robotd")
    return Check("daemon", f"serves in {directory}: robotctl status says which devices answer")
