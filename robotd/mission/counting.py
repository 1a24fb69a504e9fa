"""What happens to the robot, counted by the events that tell of it."""

from typing import NoReturn

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionProgress, SweepReadings
from robotd.core.broadcast import Broadcast
from robotd.core.counted import Counted
from robotd.core.reading import ReadingStatus

_STATUSES = tuple(ReadingStatus)


async def count_events(events: Broadcast[Event], counted: Counted) -> NoReturn:
    """Count until cancelled."""
    with events.subscribe() as stream:
        async for event in stream:
            count_event(event, counted)
    raise AssertionError("a subscription never ends")


def count_event(event: Event, counted: Counted) -> None:
    """Count what an event tells of."""
    match event:
        case SweepReadings():
            # By kind, not by reading: a batch has a handful of kinds, and a labelled counter is dearer than
            # counting bytes.
            for at in set(event.status_u8):
                counted.count("readings_total", event.status_u8.count(at), status=_STATUSES[at])
        # Predictions come with every odometry message, and an estimate of no readings tells of a new map:
        # neither is a look round.
        case PoseEstimate() if event.final and event.state is not PoseState.PREDICTED and event.readings:
            counted.count("estimates_total", state=event.state)
        case MissionProgress() if event.is_last:
            counted.count("missions_total", kind=event.kind, end=event.phase)
