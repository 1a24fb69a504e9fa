"""What a mission intends, as the world is told it: the way it drives, and what becomes of its stops."""

from collections.abc import Sequence
from dataclasses import replace

from robotd.contract.ways import Hindrance, MissionPlan, PlannedStop, Point, StopState
from robotd.core.clock import now_ns
from robotd.mission.missions.context import Reporter


class PlanTold:
    """Publishes a plan, whole, whenever it changes."""

    def __init__(self, report: Reporter, map_id: str, stops_m: Sequence[Point] = ()) -> None:
        """Intend to sweep at these stops; nothing is told yet."""
        self._report = report
        self._plan = MissionPlan(
            time_ns=0,
            mission_id=report.mission_id,
            map_id=map_id,
            start_m=None,
            goal_m=None,
            waypoints_m=(),
            stops=tuple(PlannedStop(x_m, y_m) for x_m, y_m in stops_m),
        )

    def drives(self, start_m: Point, waypoints_m: tuple[Point, ...]) -> None:
        """Tell of a way that begins here; the last of its waypoints is the goal."""
        self._tell(replace(self._plan, start_m=start_m, goal_m=waypoints_m[-1], waypoints_m=waypoints_m))

    def stop_is(
        self, number: int, state: StopState, reason: Hindrance | None = None, nearest_m: Point | None = None
    ) -> None:
        """Tell what became of a stop, and if it was not reached, why, and the nearest point that can be."""
        stops = list(self._plan.stops)
        stops[number] = replace(stops[number], state=state, reason=reason, nearest_m=nearest_m)
        self._tell(replace(self._plan, stops=tuple(stops)))

    def _tell(self, plan: MissionPlan) -> None:
        self._plan = replace(plan, time_ns=now_ns())
        self._report.publish(self._plan)
