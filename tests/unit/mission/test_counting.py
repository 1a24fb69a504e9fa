"""What happens to the robot is counted by the events that tell of it."""

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionPhase, MissionProgress
from robotd.contract.sweep_columns import in_columns
from robotd.core.counted import Counted
from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.mission.counting import count_event


def estimate(state: PoseState, readings: int, *, final: bool) -> PoseEstimate:
    return PoseEstimate(1, state, IDENTITY, (), 0, readings, final, "m")


def test_readings_estimates_and_ends_are_counted_each_once() -> None:
    ok, weak = RangeReading(0, 0.0, ReadingStatus.OK, 1.0), RangeReading(0, 0.0, ReadingStatus.WEAK, None)
    events: list[Event] = [
        in_columns(1, 0, [ok, weak, ok]),
        in_columns(1, 3, [ok]),
        estimate(PoseState.LOST, 0, final=True),  # nothing was seen yet
        estimate(PoseState.AMBIGUOUS, 100, final=False),
        estimate(PoseState.LOCALIZED, 300, final=True),
        estimate(PoseState.PREDICTED, 0, final=True),
        MissionProgress(1, 7, "localize", MissionPhase.SWEEPING, 0, 1),
        MissionProgress(1, 7, "localize", MissionPhase.DONE, 1, 1),
    ]
    counted = Counted()
    for event in events:
        count_event(event, counted)
    assert counted.counters == {
        ("readings_total", (("status", "ok"),)): 3,
        ("readings_total", (("status", "weak"),)): 1,
        ("estimates_total", (("state", "localized"),)): 1,
        ("missions_total", (("kind", "localize"), ("end", "done"))): 1,
    }
