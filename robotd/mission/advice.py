"""What the last word of mapping advises: to save the map."""

from dataclasses import replace

from robotd.contract.events import Event, MissionProgress
from robotd.mission.whereabouts.map_in_use import MapInUse


def with_advice(event: Event, place: MapInUse | None) -> Event:
    """Return an event as it is told; the journal has it as it was, for what is saved a replay does not know."""
    if not isinstance(event, MissionProgress) or event.kind != "map" or not event.is_last:
        return event
    if place is None or not place.is_unsaved:
        return event
    advice = f"the map {place.name} is not saved yet: robotctl map save"
    return replace(event, message=f"{event.message}; {advice}" if event.message else advice)
