"""Everything that can be asked of the robot, in one place; the server and a replay both ask here.

Each request that has an effect on the robot is noted in the journal before what it leads to (only a stop is on the
wires first), so a replay can ask the same again. What is refused at once has none and is not noted: a client that is
refused ten thousand times a minute must not fill the memory that recordings begin with. What fails halfway, as arming
may, is noted.
"""

import logging
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, TypeVar

from robotd.contract.answers import ConfigText, Done, MissionStarted, RecordingFile, RecordingList, Renewed
from robotd.contract.events import Event, Status
from robotd.contract.metrics import Metrics
from robotd.contract.missions import MISSIONS, Explore, MapStart, Mission, with_lease
from robotd.contract.request import Request
from robotd.contract.requests import (
    Arm,
    Clear,
    Disarm,
    GetConfig,
    GetMetrics,
    GetStatus,
    ListRecordings,
    RecordDelete,
    RecordStart,
    RecordStop,
    Renew,
    Stop,
)
from robotd.contract.topics import Topic
from robotd.core.broadcast import Broadcast
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import MissionError
from robotd.head.compute import Compute
from robotd.head.head import Head
from robotd.maps.archive import Archive
from robotd.maps.packed_content import PackedContent
from robotd.mission.map_requests import MapRequests
from robotd.mission.noted import NotedMap, noted, request_of
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.supervisor import Supervisor
from robotd.mission.whereabouts.keeping import Keeping
from robotd.recording.entries import CommandEntry
from robotd.recording.place import make_place
from robotd.recording.preroll import PrerollJournal
from robotd.recording.shelf import delete_recording, list_recordings

R = TypeVar("R")

log = logging.getLogger(__name__)


class Control:
    """The robot as its clients see it."""

    def __init__(
        self,
        supervisor: Supervisor,
        *,
        archive: Archive[PackedContent],
        journal: PrerollJournal,
        head: Head,
        disk: Compute,
        recordings_dir: Path,
        config_text: str,
    ) -> None:
        self._supervisor = supervisor
        self._archive = archive
        self._journal = journal
        self._disk = disk
        self._recordings_dir = recordings_dir
        self._config_text = config_text
        self.keeping = Keeping(supervisor, archive, head, disk)
        self._maps = MapRequests(supervisor, archive, journal, head=head, disk=disk, keeping=self.keeping)
        # A table and not a method per request: a new command is a row here, and what stops the robot is seen to
        # be the same for `stop` and `disarm`.
        self._rows: dict[type[Request[Any]], Callable[[Any], Awaitable[object]]] = {
            GetStatus: self._status,
            GetConfig: self._config,
            GetMetrics: self._metrics,
            Arm: self._arm,
            Disarm: self._stop,
            Stop: self._stop,
            Clear: self._clear,
            **dict.fromkeys(MISSIONS, self._start),
            Renew: self._renew,
            **self._maps.rows,
            RecordStart: self._start_recording,
            RecordStop: self._stop_recording,
            ListRecordings: self._list_recordings,
            RecordDelete: self._delete_recording,
        }

    @property
    def events(self) -> Broadcast[Event]:
        """Everything that happens."""
        return self._supervisor.news.events

    @property
    def status(self) -> Status:
        """The whole robot in one look."""
        return self._supervisor.status

    async def perform(self, request: Request[R], client: str = "") -> R:
        """Carry out a request and return its answer; a new map waits until the one in use is kept.

        Args:
            request: any but ``hello``.
            client: who asks; a mission is then this client's.

        Raises:
            MissionError: not now, says why; also what was stopped while it waited.
            RobotdError: as the request's row says.
        """
        # Here and not in its row: a replay keeps nothing, and asks by the rows (map_load makes way by itself).
        if isinstance(request, MapStart | Explore):
            await self._make_way(request)
        if isinstance(request, Mission):
            started: R = await self._start(request, client)  # type: ignore[assignment]  # what missions are answered
            return started
        return await self._carry_out(request)

    async def repeat(self, name: str, arguments: dict[str, Any]) -> None:
        """Carry out a request as the journal noted it.

        Raises:
            RecordingError: it is none, or its arguments do not fit; others as the request itself.
        """
        request = request_of(name, arguments)
        if isinstance(request, NotedMap):
            await self._maps.use(request, CommandEntry(now_ns(), name, arguments))
        else:
            await self._carry_out(request)

    async def _carry_out(self, request: Request[R]) -> R:
        answer: R = await self._rows[type(request)](request)  # type: ignore[assignment]  # a row answers its request
        return answer

    def halt(self, request: Stop | Disarm) -> None:
        """Stop everything and disarm, at once; valid at any time."""
        # Supervisor.halt says it again; but the note comes before that, and a stop waits for no note.
        self._supervisor.robot.stop_now()
        # A disarm is noted as the stop that it is: then there is one way to repeat both.
        self._note(Stop(request.reason), now_ns())
        self._supervisor.halt(Occasion.STOP, request.reason)

    def watch(self, topics: frozenset[Topic]) -> None:
        """Take note of what somebody reads: what is costly is made for these topics alone."""
        # Set again by each message of the front, so a front that dies leaves nothing switched on that its
        # successor does not ask for.
        self._supervisor.ranks.are_wanted = Topic.RANK in topics

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""
        await self._supervisor.mission.ended()

    def start(self, mission: Mission, lease_s: float, client: str = "") -> int:
        """Start a client's mission under a lease, whatever becomes of the map in use."""
        begun_ns = now_ns()
        mission_id = self._supervisor.mission.start(
            mission, lease_s, client
        )  # which takes its first step later: nothing is noted yet
        # With the lease that the server filled in: a replay has no settings of the server to take it from.
        self._note(with_lease(mission, lease_s), begun_ns)
        return mission_id

    def renew(self, mission_id: int) -> None:
        """Keep a mission's lease alive; MissionError if that mission is not under way.

        It is not noted: that a lease ran out is, and a client that renews a thousand times a second costs no memory.
        """
        self._supervisor.mission.renew(mission_id)

    async def _status(self, _: GetStatus) -> Status:
        return self.status

    async def _config(self, _: GetConfig) -> ConfigText:
        return ConfigText(self._config_text)

    async def _metrics(self, _: GetMetrics) -> Metrics:
        return Metrics.of(self._supervisor.counted)

    async def _arm(self, request: Arm) -> Done:
        # What is refused is refused before it is noted: a replay would arm a robot that was not armed.
        self._supervisor.arming.require_armable()
        self._note(request, now_ns())
        await self._supervisor.arming.arm()
        return Done()

    async def _stop(self, request: Stop | Disarm) -> Done:
        self.halt(request)
        await self.stopped()
        return Done()

    async def _clear(self, request: Clear) -> Done:
        # As with arming: what is refused is not noted.
        self._supervisor.arming.require_clearable()
        self._note(request, now_ns())
        await self._supervisor.arming.clear()
        return Done()

    async def _start(self, mission: Mission, client: str = "") -> MissionStarted:
        # The server fills in its own where a client names none; without any nothing may move.
        if mission.lease_s is None:
            raise MissionError(f"{mission.cmd} needs a lease")
        return MissionStarted(self.start(mission, mission.lease_s, client), mission.lease_s)

    async def _make_way(self, request: MapStart | Explore) -> None:
        halts = self._supervisor.halts
        # An hour of exploring must not end at a disk that was full, or read-only, from the start.
        if isinstance(request, Explore):
            await self._disk.run("try the store", self._archive.require_writable)
        # What is resumed goes on with the map in use, so no other one comes in its place.
        if not (isinstance(request, Explore) and request.resume):
            await self.keeping.make_way()
        # The disk takes its time: a stop that came meanwhile counts, even if the robot was armed again since.
        if self._supervisor.halts != halts:
            raise MissionError("stopped while the map in use was being kept")

    async def _renew(self, request: Renew) -> Renewed:
        self.renew(request.mission_id)
        return Renewed(None)

    async def _start_recording(self, request: RecordStart) -> RecordingFile:
        """Record from the daemon's start on, to a file below the directory of recordings.

        Raises:
            RecordingError: the file is to lie elsewhere, or it cannot be done now.
        """
        # Named by the wall clock, as people look for recordings; two of one boot never share a nanosecond.
        name = f"{now_ns() + wall_offset_ns()}.mcap" if request.path is None else request.path
        file = await self._disk.run("make directory", make_place, self._recordings_dir, name, self._archive.root)
        self._journal.start(file)
        log.info("recording to %s", file)
        # The status names the file: who watches need not wait for its next turn in a second.
        self._supervisor.publish_status()
        return RecordingFile(str(file))

    async def _stop_recording(self, _: RecordStop) -> RecordingFile:
        """End the recording; RecordingError if it is incomplete."""
        path = self._journal.path
        if path is None:
            return RecordingFile(None)
        # From here no entry is taken, so the status is true already; only the file waits for the disk.
        finish = self._journal.stop()
        self._supervisor.publish_status()
        await self._disk.run("end recording", finish)
        log.info("the recording %s is complete", path)
        return RecordingFile(str(path))

    async def _list_recordings(self, _: ListRecordings) -> RecordingList:
        return await self._disk.run("list recordings", list_recordings, *self._shelf)

    async def _delete_recording(self, request: RecordDelete) -> Done:
        """Remove a recording; RecordingError says why not."""
        await self._disk.run("delete recording", delete_recording, *self._shelf, request.path)
        log.info("the recording %s was deleted", request.path)
        return Done()

    @property
    def _shelf(self) -> tuple[Path, Path, Path | None]:
        """Where recordings are, what they are not, and the one under way."""
        return self._recordings_dir, self._archive.root, self._journal.path

    def _note(self, request: Request[Any], time_ns: int) -> None:
        self._journal.command(time_ns, *noted(request))
