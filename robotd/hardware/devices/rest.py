"""Whether a device that tells of itself all the time has said that it rests."""

import asyncio
from collections.abc import Set as AbstractSet


class Rest:
    """What was last told of each thing that must be over, since somebody began to wait."""

    def __init__(self) -> None:
        self._goes_on: dict[str, bool] = {}
        self._told = asyncio.Event()

    def told(self, what: str, *, goes_on: bool) -> None:
        """Note what the device says."""
        self._goes_on[what] = goes_on
        self._told.set()

    async def seen(self, wanted: AbstractSet[str]) -> None:
        """Return once the device said of everything wanted, from now on, that it is over."""
        self._goes_on.clear()  # what was told before was told before the stop
        # What it has not spoken of since counts as going on.
        while any(self._goes_on.get(what, True) for what in wanted):
            self._told.clear()
            await self._told.wait()
