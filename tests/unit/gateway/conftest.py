"""A daemon's front with a fake robot behind it, as the tests of the server have it."""

from tests.unit.server.conftest import serving

__all__ = ["serving"]
