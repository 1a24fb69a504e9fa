"""An emulated robot by name: one of the worlds, a world file, the yaml of a map, or the file of a recorded building."""

from pathlib import Path

from robotd.sim.buildings.building import load_recorded_building
from robotd.sim.buildings.map_world import load_map_world
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.recorded_robot import OdometrySource, RecordedRobot
from robotd.sim.robot import EmulatedRobot, SimSettings, SimulatedRobot

_GZIP_MAGIC = b"\x1f\x8b"


def load_robot(
    name_or_path: str,
    seed: int = 0,
    *,
    settings: SimSettings | None = None,
    odometry: OdometrySource = OdometrySource.CORRECTED,
    boot: int = 0,
    dialects: Dialects | None = None,
) -> EmulatedRobot:
    """Return a robot in a world, in a map, or in a recorded building.

    Args:
        name_or_path: name of a world, or a file.
        seed: of all that is random.
        settings: of the hardware in a world; a recorded building has none.
        odometry: what the wheels say in a recorded building; a world has its own physics.
        boot: how often the boards were powered up before.
        dialects: what the devices speak; our own boards' protocol if None.

    Raises:
        ConfigError: there is no such world or map, or it is damaged.
        RecordingError: the file of a recorded building is damaged.
    """
    if _is_building(Path(name_or_path)):
        return RecordedRobot(
            load_recorded_building(Path(name_or_path)), seed, odometry=odometry, boot=boot, dialects=dialects
        )
    world = load_map_world(Path(name_or_path)) if _is_map(name_or_path) else load_world(name_or_path)
    return SimulatedRobot(world, seed, settings, boot=boot, dialects=dialects)


def _is_map(name_or_path: str) -> bool:
    return name_or_path.endswith((".yaml", ".yml"))


def _is_building(path: Path) -> bool:
    if not path.is_file():
        return False
    # By what it holds: the file of a building may have any name.
    with path.open("rb") as file:
        return file.read(len(_GZIP_MAGIC)) == _GZIP_MAGIC
