"""Which fault begins on which cable when, and for how long: as words on the command line, and carried out."""

import asyncio
import itertools
import random
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import ConfigError
from robotd.sim.faults.cable import Cable
from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.faults.of_plugs import Reboot
from robotd.sim.robot import DEVICES

ALL = "all"
_ENTRY = re.compile(r"(?P<device>[a-z]+):(?P<fault>[a-z]+)@(?P<start>\d+(?:\.\d+)?)s(?:\+(?P<lasts>\d+(?:\.\d+)?)s)?")


@dataclass(frozen=True, slots=True)
class PlannedFault:
    """One fault on one cable."""

    device: str
    fault: str
    start_s: float
    """After the boards were powered up."""
    lasts_s: float | None = None
    """None: to the end."""

    @property
    def end_s(self) -> float:
        """When it is over."""
        return float("inf") if self.lasts_s is None else self.start_s + self.lasts_s


def parse_plan(text: str) -> tuple[PlannedFault, ...]:
    """Read ``DEVICE:FAULT@START[+DURATION],...`` and return its faults in the order in which they begin.

    Raises:
        ConfigError: it is no plan, or two faults are on one cable at the same time; says which.

    >>> parse_plan("drive:unplug@20s")
    (PlannedFault(device='drive', fault='unplug', start_s=20.0, lasts_s=None),)
    """
    faults = [fault for entry in text.split(",") for fault in _entry(entry.strip())]
    faults.sort(key=lambda fault: (fault.start_s, fault.device))
    for device in DEVICES:
        _check_one_at_a_time([fault for fault in faults if fault.device == device])
    return tuple(faults)


def _entry(text: str) -> list[PlannedFault]:
    found = _ENTRY.fullmatch(text)
    if found is None:
        raise ConfigError(f"expected DEVICE:FAULT@START[+DURATION], as in drive:unplug@20s+2s, got {text!r}")
    device, fault = found["device"], found["fault"]
    if device not in (*DEVICES, ALL):
        raise ConfigError(f"no such device: {device!r}; known: {', '.join((*DEVICES, ALL))}")
    if fault not in FAULTS:
        raise ConfigError(f"no such fault: {fault!r}; known: {', '.join(FAULTS)}")
    lasts_s = None if found["lasts"] is None else float(found["lasts"])
    hit = DEVICES if device == ALL else (device,)
    return [PlannedFault(one, fault, float(found["start"]), lasts_s) for one in hit]


def _check_one_at_a_time(faults: list[PlannedFault]) -> None:
    for before, after in itertools.pairwise(faults):
        if after.start_s < before.end_s:
            raise ConfigError(
                f"{after.device}:{after.fault}@{after.start_s:g}s begins before {before.fault} is over:"
                " one fault at a time on each cable"
            )


async def carry_out(
    plan: tuple[PlannedFault, ...], cables: Mapping[str, Cable], seed: int, say: Callable[[str], None]
) -> None:
    """Begin and end the faults in their time, and say so; the same seed gives the same luck.

    Raises:
        ConfigError: a board cannot do what is asked of it; nothing has happened then.
    """
    for fault in plan:
        if FAULTS[fault.fault] is Reboot and not cables[fault.device].can_reboot:
            raise ConfigError("only our own boards can be rebooted", key=fault.device)
    begun_ns = now_ns()
    async with asyncio.TaskGroup() as group:
        for number, fault in enumerate(plan):
            # Luck of its own for each: what one draws does not depend on when others draw.
            rng = random.Random(f"{seed}/{number}/{fault.device}/{fault.fault}")
            group.create_task(_happen(fault, cables[fault.device], rng, begun_ns, say))


async def _happen(
    planned: PlannedFault, cable: Cable, rng: random.Random, begun_ns: int, say: Callable[[str], None]
) -> None:
    await _until(begun_ns, planned.start_s)
    say(f"{planned.device}: {planned.fault} begins")
    fault = FAULTS[planned.fault](rng)
    cable.set_fault(fault)
    if planned.lasts_s is None:
        return
    await _until(begun_ns, planned.end_s)  # from the beginning of all, so that delays do not add up
    if cable.fault is fault:  # where one begins as another ends, the one may already be there
        cable.mend()
    say(f"{planned.device}: {planned.fault} is over")


async def _until(begun_ns: int, after_s: float) -> None:
    await asyncio.sleep(max(0.0, after_s - (now_ns() - begun_ns) / NS_PER_S))
