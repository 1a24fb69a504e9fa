"""What the flows of the console run on."""

from tests.unit.gateway.rig import opening
from tests.unit.server.conftest import serving

__all__ = ["opening", "serving"]
