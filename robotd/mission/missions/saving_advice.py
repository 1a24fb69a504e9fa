"""What the last word of mapping advises: to save the map."""

from dataclasses import replace

from robotd.contract.events import MissionProgress
from robotd.contract.missions import Explore, MapStart
from robotd.mission.whereabouts.map_in_use import MapInUse


def with_advice(event: MissionProgress, place: MapInUse | None) -> MissionProgress:
    """Return a step of a mission as it is told; the journal has it as it was: a replay does not know what is saved."""
    if event.kind not in {MapStart.kind, Explore.kind} or not event.is_last or place is None or not place.is_unsaved:
        return event
    advice = f"the map {place.name} is not saved yet: robotctl map save"
    return replace(event, message=f"{event.message}; {advice}" if event.message else advice)
