"""The clients of the daemon: one for programs without an event loop, one for programs with one.

They know the contract and nothing of the engine: importing them loads no grid, no maps, no devices and no kernels.
"""

from robotd.client.async_client import AsyncClient, AsyncSubscription
from robotd.client.feed import Gap
from robotd.client.sync_client import Client, Subscription

__all__ = ["AsyncClient", "AsyncSubscription", "Client", "Gap", "Subscription"]
