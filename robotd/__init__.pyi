# For type checkers alone: `__init__.py` loads these when they are first asked for, and no contract between rooms is to
# take that for an import.
from robotd.core.pose import Pose2 as Pose2
from robotd.core.reading import Sweep as Sweep
from robotd.library.map import Map as Map

__all__ = ["Map", "Pose2", "Sweep", "__version__"]
__version__: str
