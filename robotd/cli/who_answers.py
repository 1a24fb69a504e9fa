"""Who answers on the ports of this machine, asked of all of them at once."""

import asyncio
from collections.abc import Iterable

from robotd.core.errors import RobotdError
from robotd.hardware.devices.catalogue import SPEAKERS
from robotd.hardware.devices.finding import Recognized, found_on
from robotd.hardware.wire.enquiry import NotAsked


def who_answers(ports: Iterable[str]) -> dict[str, Recognized | str]:
    """Return for each port who is there, or in words why nobody was found."""
    return asyncio.run(_all(tuple(ports)))


async def _all(ports: tuple[str, ...]) -> dict[str, Recognized | str]:
    return dict(zip(ports, await asyncio.gather(*map(_one, ports)), strict=True))


async def _one(port: str) -> Recognized | str:
    try:
        return await found_on(port) or "nobody answered"
    except RobotdError as error:
        return str(error).removeprefix(f"{port}: ")


def not_asked(device: str) -> str:
    """Say which dialects of a device nobody asks, and why; empty if all are."""
    whys: dict[str, list[str]] = {}
    for name, speaker in SPEAKERS[device].items():
        if speaker.speech is not None and isinstance(speaker.speech.enquiry, NotAsked):
            whys.setdefault(speaker.speech.enquiry.why, []).append(name)
    return "; ".join(f"nobody asks for {' or '.join(names)}: {why}" for why, names in whys.items())
