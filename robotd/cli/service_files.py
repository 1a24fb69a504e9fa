"""What a system needs of robotd, where each of it goes, and what of it is the owner's to change."""

import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import robotd
from robotd.core.errors import RobotdError

_PREFIX = "/opt/robotd"
"""Where the units that are shipped have the program."""
_STEPS_SINCE = 254
"""Version of systemd that knows RestartSteps=; an older one would try again each second for ever."""
_STEPS = re.compile(r"^RestartSec=.*\nRestartSteps=.*\nRestartMaxDelaySec=.*\n", re.MULTILINE)
_WITHOUT_STEPS = "RestartSec=5s\n"
_PLACES = (
    (".sysusers.conf", "etc/sysusers.d", ".conf", False),
    (".tmpfiles.conf", "etc/tmpfiles.d", ".conf", False),
    (".service", "etc/systemd/system", ".service", False),
    (".rules", "etc/udev/rules.d", ".rules", True),
    (".toml", "etc/robotd", ".toml", True),
)
"""Ending, directory, ending there, and whether what is there is its owner's: numbers of boards, settings."""
_SHARED = ("man/man1/{}.1", "bash-completion/completions/{}", "zsh/site-functions/_{}")
"""Manuals and completions below ``share``, where a wheel has them; a clone has none."""
_PROGRAMS = ("robotctl", "robotd", "robotd-gateway")


class Fate(StrEnum):
    """What becomes of a file."""

    NEW = "new"
    REPLACED = "replaced"
    SAME = "as it is"
    KEPT = "kept as you have it"


@dataclass(frozen=True, slots=True)
class ServiceFile:
    """One file, where it goes, and what becomes of one that is there."""

    path: Path
    content: bytes
    fate: Fate

    @property
    def is_written(self) -> bool:
        """Whether it has to be."""
        return self.fate in {Fate.NEW, Fate.REPLACED}


def service_files(prefix: Path, root: Path, systemd: int | None) -> Iterator[ServiceFile]:
    """Yield the files of an installation.

    Args:
        prefix: the virtual environment with the program, as the service will see it.
        root: the directory that stands for ``/``.
        systemd: which version will read them; None for any that knows all that is used.

    Raises:
        RobotdError: one that is there cannot be read.
    """
    for source in sorted((Path(robotd.__file__).parent / "systemd").iterdir()):
        for ending, directory, new_ending, is_owners in _PLACES:
            if source.name.endswith(ending):
                path = root / directory / f"{source.name.removesuffix(ending)}{new_ending}"
                content = _adapted(source.read_text(), prefix, systemd).encode()
                yield ServiceFile(path, content, _fate(path, content, is_owners=is_owners))
    brought = root / prefix.relative_to("/") / "share"
    for place in (place.format(program) for program in _PROGRAMS for place in _SHARED):
        if (brought / place).exists():
            path, content = root / "usr/local/share" / place, (brought / place).read_bytes()
            yield ServiceFile(path, content, _fate(path, content, is_owners=False))


def systemd_version() -> int | None:
    """Return which systemd runs here, None if none does."""
    try:
        said = subprocess.run(["systemctl", "--version"], capture_output=True, text=True, timeout=5.0, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    found = re.match(r"systemd (\d+)", said.stdout)
    return int(found[1]) if found else None


def _adapted(text: str, prefix: Path, systemd: int | None) -> str:
    if systemd is not None and systemd < _STEPS_SINCE:
        text = _STEPS.sub(_WITHOUT_STEPS, text)
    return text.replace(f"={_PREFIX}/", f"={prefix}/")


def _fate(path: Path, content: bytes, *, is_owners: bool) -> Fate:
    try:
        there = path.read_bytes()
    except FileNotFoundError:
        return Fate.NEW
    except OSError as error:
        raise RobotdError(f"{path}: {error.strerror or error}") from error
    if there == content:
        return Fate.SAME
    return Fate.KEPT if is_owners else Fate.REPLACED
