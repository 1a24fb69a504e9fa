"""The clients of the daemon: one for programs without an event loop, one for programs with one.

They know the contract and nothing of the engine: importing them loads no grid, no maps, no devices and no kernels.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robotd.client.async_client import AsyncClient, AsyncSubscription
    from robotd.client.feed import Gap
    from robotd.client.sync_client import Client, Subscription

__all__ = ["AsyncClient", "AsyncSubscription", "Client", "Gap", "Subscription"]

_HOMES = {
    "AsyncClient": "async_client",
    "AsyncSubscription": "async_client",
    "Client": "sync_client",
    "Gap": "feed",
    "Subscription": "sync_client",
}


def __getattr__(name: str) -> Any:
    # Not imported above: who needs one client, or what happens on a mission, waits for no other, nor for ZeroMQ.
    if name in _HOMES:
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
