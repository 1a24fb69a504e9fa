"""Where maps and stops are held by number, and what is done with them; the same in a process of its own and in a test.

One job at a time, each to its end, so nothing here waits, reads a clock or shares anything with a thread.
"""

from collections.abc import Callable

from robotd.core.reading import Tilt
from robotd.head.held import Held
from robotd.head.jobs import MapRef, Prepare
from robotd.head.parts import Parts
from robotd.head.settings import HeadSettings
from robotd.head.wire import NotHeld
from robotd.localization.at_stop import estimator_at_stop
from robotd.localization.estimator import Estimator
from robotd.localization.ready_map import ReadyMap

Begin = Callable[[ReadyMap, Prepare], Estimator]
"""The seam for another estimator: begins a stop on a map, with no readings."""


class Desk:
    """Everything that is held."""

    def __init__(self, settings: HeadSettings, *, threads: int = 1, begin: Begin | None = None) -> None:
        """Hold nothing yet.

        Args:
            settings: what all jobs are done by.
            threads: how many threads may share the work when it is much; no answer depends on it.
            begin: begins a stop; as the settings have it if there is none.
        """
        self.settings = settings
        self.parts = Parts()
        """Of the map that a client brings."""
        self._maps: dict[int, dict[int, Held]] = {}
        """By number, then by generation."""
        self._stops: dict[int, Estimator] = {}
        self._threads = threads
        self._begin = begin or self._as_set

    def hold(self, ref: MapRef, held: Held) -> Held:
        """Hold a map under its number and generation, and return it."""
        self._maps.setdefault(ref.number, {})[ref.generation] = held
        return held

    def map(self, ref: MapRef) -> Held:
        """Return a map, and let go of its generations before that one: who asks goes on from here.

        Raises:
            NotHeld: there is none.
        """
        generations = self._maps.get(ref.number, {})
        if ref.generation not in generations:
            raise NotHeld(f"no map {ref.number} of generation {ref.generation} is held")
        # Not at the insertion: a mission that was stopped meanwhile goes on from the generation before.
        for older in [generation for generation in generations if generation < ref.generation]:
            del generations[older]
        return generations[ref.generation]

    def ready(self, ref: MapRef) -> ReadyMap:
        """Return a map made ready for localization; NotHeld if there is none."""
        # Made when it is first localized on: a map in the making is never, unless stops are placed on it.
        held, ready = self.map(ref).made_ready(self.settings.localization, self.settings.error_model)
        # Kept with the generation: the next look on it finds it ready.
        self.hold(ref, held)
        return ready

    def layers(self, ref: MapRef) -> tuple[tuple[Tilt, ReadyMap], ...]:
        """Return the further layers of a map made ready for localization; NotHeld if there is none."""
        held, ready = self.map(ref).layers_ready(self.settings.localization, self.settings.error_model)
        self.hold(ref, held)
        return ready

    def begin(self, job: Prepare) -> None:
        """Hold a stop, on its map made ready."""
        self._stops[job.number] = self._begin(self.ready(job.map), job)

    def stop(self, number: int) -> Estimator:
        """Return a stop; NotHeld if there is none."""
        if number not in self._stops:
            raise NotHeld(f"no stop {number} is held")
        return self._stops[number]

    def holds_stop(self, number: int) -> bool:
        """Return whether there is a stop of that number."""
        return number in self._stops

    def forget(self, number: int) -> None:
        """Hold what has this number no longer, if anything has."""
        self._maps.pop(number, None)
        self._stops.pop(number, None)

    def _as_set(self, ready: ReadyMap, job: Prepare) -> Estimator:
        judgement = self.settings.judgement.no_surer(job.contrast_min)
        return estimator_at_stop(
            ready,
            job.map_id,
            job.headings_rad,
            job.within,
            judgement=judgement,
            layers=self.layers(job.map) if job.layers else (),
            threads=self._threads,
            tells_smallest_error=job.tells_smallest_error,
        )
