"""``demo room``, ``demo building``, ``demo console``: what ``make demo``, ``make demo-real``, ``make console`` call."""

from robotd.cli.demo import console, real_building, room
from robotd.cli.verb import Verb

VERBS = (
    Verb(
        "demo room",
        "show the main job: a simulated robot maps a room over real serial protocol, and is found in it",
        "robotctl demo room laboratory",
        room.run,
        room.add_arguments,
    ),
    Verb(
        "demo building",
        "the same in a recorded building: map real stops of a CARMEN log, then be found at those kept out of the map",
        "robotctl demo building intel.corrected.log.gz",
        real_building.run,
        real_building.add_arguments,
    ),
    Verb(
        "demo console",
        "start a simulated robot, the daemon and the console, and print an address for a browser",
        "robotctl demo console laboratory",
        console.run,
        console.add_arguments,
    ),
)
