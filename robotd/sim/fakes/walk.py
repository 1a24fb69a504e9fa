"""Walks through the script of a session in step with a living host.

What the recorded board said comes out at its recorded pace, counted from the last request that it followed. When
the walk comes to a request, it waits until the host makes it; when the host is early, the walk catches up.
"""

from dataclasses import dataclass

from firmware_proto.drive_messages import SetVelocity
from firmware_proto.schema import Message
from robotd.sim.fakes.script import BOOKKEEPING, Said, ScriptedRequest, Step, asked_ahead


@dataclass(frozen=True, slots=True)
class Meeting:
    """The host's request met one of the script."""

    place: int
    """Which step."""
    asked: ScriptedRequest
    skipped: tuple[ScriptedRequest, ...]
    """Requests of the script that the host left out."""
    caught_up: tuple[Said, ...]
    """What must be said before the answer."""

    def agrees(self, request: Message) -> bool:
        """Whether the host asked exactly for what the script says; how long a set-point lives does not matter."""
        if isinstance(request, SetVelocity) and isinstance(self.asked.request, SetVelocity):
            wanted = self.asked.request
            return (request.speed_mmps, request.turn_mradps) == (wanted.speed_mmps, wanted.turn_mradps)
        return request == self.asked.request


class Walk:
    """Where in its script a session is."""

    def __init__(self, steps: tuple[Step, ...], now_us: int) -> None:
        """Stand before the first step."""
        self._steps = steps
        self._at = 0
        self._base_us = now_us
        self._recorded_base_us = steps[0].time_us if steps else 0

    @property
    def due_us(self) -> int | None:
        """When the next thing is to be said; None while the walk waits for the host, and at its end."""
        step = self._steps[self._at] if self._at < len(self._steps) else None
        if not isinstance(step, Said):
            return None
        return self._base_us + step.time_us - self._recorded_base_us

    @property
    def expected(self) -> ScriptedRequest | None:
        """The request that the script has next."""
        return next((asked for _, asked in asked_ahead(self._steps, self._at)), None)

    @property
    def finished(self) -> bool:
        """Whether the host has asked for all but what a client may or may not want in the end."""
        return all(isinstance(asked.request, BOOKKEEPING) for _, asked in asked_ahead(self._steps, self._at))

    def take_due(self, now_us: int) -> list[Said]:
        """Return what is to be said by now, and step past it."""
        due = []
        while self.due_us is not None and self.due_us <= now_us:
            step = self._steps[self._at]
            assert isinstance(step, Said)  # only those fall due
            due.append(step)
            self._at += 1
        return due

    def meet(self, request: Message, now_us: int) -> Meeting | None:
        """Step past the next request of this type; None if the script does not expect one here.

        On the way only bookkeeping is passed over: a mission's requests come in their order or not at all.
        """
        skipped: list[ScriptedRequest] = []
        for place, asked in asked_ahead(self._steps, self._at):
            if type(asked.request) is type(request):
                caught_up = _essence(self._steps[self._at : place])
                self._at = place + 1
                self._base_us, self._recorded_base_us = now_us, asked.time_us
                return Meeting(place, asked, tuple(skipped), caught_up)
            if not isinstance(asked.request, BOOKKEEPING):
                return None
            skipped.append(asked)
        return None


def _essence(steps: tuple[Step, ...]) -> tuple[Said, ...]:
    """Return every answer, and of each kind of telemetry the newest: it repeats or adds up, so nothing is lost."""
    newest = {
        type(step.message): at for at, step in enumerate(steps) if isinstance(step, Said) and step.answers is None
    }
    return tuple(
        step
        for at, step in enumerate(steps)
        if isinstance(step, Said) and (step.answers is not None or newest[type(step.message)] == at)
    )
