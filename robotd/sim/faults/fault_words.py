"""The faults by the words that name them."""

from collections.abc import Mapping

from robotd.sim.faults.fault import Fault
from robotd.sim.faults.of_bytes import BitFlips, Garbage, HalfBaud, StuckByte
from robotd.sim.faults.of_flow import Blocked, Drip, Flood, SilentLine
from robotd.sim.faults.of_frames import Doubled, Dropped, Split
from robotd.sim.faults.of_plugs import Reboot, Replug, Unplug, WriteFails, WrongIdentity

FAULTS: Mapping[str, type[Fault]] = {
    "unplug": Unplug,
    "replug": Replug,
    "identity": WrongIdentity,
    "reboot": Reboot,
    "eio": WriteFails,
    "blocked": Blocked,
    "silence": SilentLine,
    "drip": Drip,
    "flood": Flood,
    "garbage": Garbage,
    "halfbaud": HalfBaud,
    "stuck": StuckByte,
    "bitflips": BitFlips,
    "drop": Dropped,
    "double": Doubled,
    "split": Split,
}
"""Each has its meaning as the first line of its class."""


def meaning_of(word: str) -> str:
    """Return what a fault does, for people."""
    return (FAULTS[word].__doc__ or "").strip()
