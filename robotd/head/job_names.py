"""Every job there is, by its name on the way to a head."""

from typing import Any

from robotd.head.job import Job
from robotd.head.jobs import (
    BeginMap,
    Choose,
    ChooseBearings,
    ChooseSafeWay,
    Forget,
    Glance,
    Insert,
    MakeFiles,
    Narrow,
    PlaceStop,
    Plan,
    Prepare,
    PreviewWay,
    ReadMap,
    ShowMap,
    ShowRanks,
    TakeMap,
    TakeReadings,
)
from robotd.head.parts_jobs import TakePart

JOBS: dict[str, type[Job[Any]]] = {
    kind.name: kind
    for kind in (
        *(BeginMap, TakeMap, ReadMap, ShowMap, MakeFiles, TakePart, Insert, PlaceStop, Glance),
        *(Prepare, Narrow, TakeReadings, ShowRanks),
        *(Plan, PreviewWay, Choose, ChooseBearings, ChooseSafeWay, Forget),
    )
}
"""All of them."""
