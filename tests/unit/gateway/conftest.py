"""A daemon's front with a fake robot behind it, as the tests of the server have it, and a gateway before it."""

from tests.unit.gateway.rig import opening
from tests.unit.server.conftest import serving

__all__ = ["opening", "serving"]
