"""The map that a daemon takes into use by itself when it starts, if its configuration names one."""

import logging

from robotd.app.compose import Daemon
from robotd.config.sections import LAST
from robotd.contract.answers import MapEntryInfo
from robotd.contract.requests import ListMaps, MapLoad
from robotd.core.errors import RobotdError

log = logging.getLogger(__name__)


async def load_first_map(daemon: Daemon, wanted: str) -> None:
    """Load a map as a client's request would; where the robot stands on it, nothing says.

    A daemon without its map is better than no daemon: what goes wrong is said in the log.

    Args:
        daemon: which takes it into use.
        wanted: its name, or ``last`` for the one that somebody saved last; nothing is loaded if it is empty.
    """
    if not wanted:
        return
    try:
        name = wanted if wanted != LAST else _last((await daemon.control.perform(ListMaps())).maps)
        if name is None:
            log.warning("maps.load = %r: no map was saved yet", LAST)
            return
        # As a client would ask: it is noted in the journal, so a replay has it, too.
        await daemon.control.perform(MapLoad(name))
    except RobotdError as error:
        log.error("maps.load = %r: %s", wanted, error)  # noqa: TRY400  # foreseen


def _last(entries: tuple[MapEntryInfo, ...]) -> str | None:
    """Return the map that was saved last, None if there is none; what was only kept was saved by nobody."""
    saved = [entry for entry in entries if not (entry.unsaved or entry.damage)]
    return max(saved, key=lambda entry: entry.created_unix_ns).name if saved else None
