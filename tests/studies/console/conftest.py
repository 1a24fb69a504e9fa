"""A daemon's front with a fake robot behind it, and a gateway before it, as the tests of the gateway have them."""

from tests.unit.gateway.rig import opening
from tests.unit.server.conftest import serving

__all__ = ["opening", "serving"]
