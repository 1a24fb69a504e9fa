"""Who drives, whether somebody looks, and that the robot stops when nobody does: on the virtual clock."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable
from itertools import pairwise
from typing import Any, Self, TypeVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.contract.answers import Done, MissionStarted, Renewed
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import Status
from robotd.contract.missions import DriveTo
from robotd.contract.modes import Mode
from robotd.contract.request import Request
from robotd.contract.requests import Renew, Stop
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import ServerError
from robotd.gateway.browser.liveness import Liveness
from robotd.gateway.command.arbiter import ASKED_S, Arbiter, Driver
from robotd.gateway.command.asker import UNKNOWN
from robotd.gateway.command.idle import Idle
from robotd.gateway.command.kept_missions import Missions
from robotd.gateway.command.stop_line import GIVEN_UP_S, StopLine

R = TypeVar("R")
ANNA, OTTO, IDA = Driver("a", "anna"), Driver("o", "otto"), Driver("i", "ida")


class Daemon:
    """Answers as it is told to, and notes what it is asked, and when."""

    def __init__(self) -> None:
        self.asked: list[tuple[float, str]] = []
        self.answer: Callable[[Request[Any]], Awaitable[Any]] = self.well
        self.reasons: list[str] = []

    async def ask(self, request: Request[R], within_s: float | None = None, who: str | None = None) -> R:
        self.asked.append((now_ns() / NS_PER_S, request.cmd))
        if isinstance(request, Stop):
            self.reasons.append(request.reason)
        async with asyncio.timeout(within_s):
            answer: R = await self.answer(request)
        return answer

    async def well(self, request: Request[Any]) -> Any:
        if isinstance(request, Renew):
            return Renewed(None)
        return Done() if isinstance(request, Stop) else MissionStarted(7, 0.5)

    def times(self, cmd: str) -> list[float]:
        return [at for at, asked in self.asked if asked == cmd]


class Rig:
    """Missions with pages of which the test says how long they have been silent."""

    def __init__(self) -> None:
        self.daemon, self.arbiter = Daemon(), Arbiter()
        self.silent_since: dict[str, float] = {}
        self.told = 0
        self.missions = Missions(
            self.daemon,
            StopLine(self.daemon),
            self.arbiter,
            silent_s=self._silent_s,
            patience_s=1.5,
            changed=self._changed,
        )

    async def __aenter__(self) -> Self:
        self._watching = asyncio.create_task(self.missions.watch())
        await asyncio.sleep(0)  # a duty that never began would clear nothing up
        return self

    async def __aexit__(self, *_: object) -> None:
        self._watching.cancel()
        await asyncio.wait((self._watching,))

    def _silent_s(self, browser: str) -> float:
        since = self.silent_since.get(browser)
        return 0.0 if since is None else now_ns() / NS_PER_S - since

    def _changed(self) -> None:
        self.told += 1


def test_questions_are_answered_once_each_and_never_before_they_are_asked() -> None:
    page = Liveness(0.0)
    assert not page.answer(1, 1.0)
    assert [page.ask(), page.ask()] == [1, 2]
    assert page.answer(2, 2.0)
    assert not page.answer(2, 3.0)
    assert not page.answer(1, 3.0)
    assert not page.answer(99, 3.0)
    assert page.silent_s(3.5) == 1.5


async def test_a_lease_is_renewed_four_times_in_its_time() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        await asyncio.sleep(2.0)
        renewals = rig.daemon.times("renew")
        assert len(renewals) == 17
        assert max(b - a for a, b in pairwise(renewals)) <= 0.126
        assert rig.daemon.times("stop") == []


async def test_a_page_that_hangs_stops_the_robot_within_its_patience_and_is_blamed() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        await asyncio.sleep(1.0)
        rig.silent_since["a"] = silent_since = now_ns() / NS_PER_S
        await asyncio.sleep(3.0)
        (stopped,) = rig.daemon.times("stop")
        assert 1.5 < stopped - silent_since <= 1.6
        assert rig.daemon.reasons == ["the page of anna, who drove, has not answered for 1.5 s"]
        assert rig.daemon.times("renew")[-1] <= stopped, "what is stopped is renewed no more"


async def test_an_unattended_mission_goes_on_though_the_page_hangs_and_goes() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=False)
        rig.silent_since["a"] = now_ns() / NS_PER_S
        await asyncio.sleep(3.0)
        rig.missions.gone("a")
        await asyncio.sleep(3.0)
        assert rig.daemon.times("stop") == []
        assert rig.daemon.times("renew")[-1] > 5.8


async def test_a_page_that_closes_stops_its_mission_at_once() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        rig.missions.gone("o")
        await asyncio.sleep(0.2)
        assert rig.daemon.times("stop") == []
        rig.missions.gone("a")
        await asyncio.sleep(0.01)
        assert rig.daemon.reasons == ["anna, who drove, has left the console"]


async def test_a_renewal_without_an_answer_holds_up_no_other() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)

        async def silent(request: Request[Any]) -> Any:
            raise ServerError(UNKNOWN, "no answer")

        rig.daemon.answer = silent
        await asyncio.sleep(1.0)
        assert len(rig.daemon.times("renew")) >= 7
        assert rig.arbiter.commander is not None
        rig.daemon.answer = rig.daemon.well


async def test_a_mission_whose_outcome_is_unknown_is_nobodys() -> None:
    async with Rig() as rig:

        async def silent(request: Request[Any]) -> Any:
            raise ServerError(UNKNOWN, "drive_to: no answer")

        rig.daemon.answer = silent
        with pytest.raises(ServerError, match="its lease ends it"):
            await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        assert rig.arbiter.commander is None
        rig.daemon.answer = rig.daemon.well
        await rig.missions.start(OTTO, DriveTo(1.0, 2.0), attended=True)
        assert rig.daemon.times("renew") == []


async def test_two_pages_that_press_go_start_one_mission() -> None:
    async with Rig() as rig:
        both = await asyncio.gather(
            rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True),
            rig.missions.start(OTTO, DriveTo(3.0, 4.0), attended=True),
            return_exceptions=True,
        )
        assert isinstance(both[0], MissionStarted)
        assert str(both[1]) == "refused: anna drives already: wait, stop it, or take over"
        assert len(rig.daemon.times("drive_to")) == 1


async def test_a_mission_that_ended_is_commanded_by_nobody() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        rig.missions.ended(6)
        assert rig.told == 1, "that was another one"
        rig.missions.ended(7)
        assert rig.told == 2
        renewed = len(rig.daemon.times("renew"))
        await asyncio.sleep(1.0)
        assert len(rig.daemon.times("renew")) == renewed


async def test_who_takes_over_has_to_answer_from_then_on() -> None:
    async with Rig() as rig:
        await rig.missions.start(ANNA, DriveTo(1.0, 2.0), attended=True)
        rig.arbiter.ask_for(OTTO, now_ns() / NS_PER_S)
        await asyncio.sleep(ASKED_S + 0.1)
        assert rig.arbiter.commander is not None
        assert rig.arbiter.commander.driver == OTTO
        rig.silent_since["a"] = now_ns() / NS_PER_S
        await asyncio.sleep(2.0)
        assert rig.daemon.times("stop") == []
        rig.silent_since["o"] = now_ns() / NS_PER_S
        await asyncio.sleep(2.0)
        assert len(rig.daemon.times("stop")) == 1


def commanded() -> Arbiter:
    arbiter = Arbiter()
    arbiter.start(ANNA)
    arbiter.began(7, "drive", 0, attended=True)
    return arbiter


def test_the_commander_may_give_or_keep() -> None:
    arbiter = commanded()
    arbiter.ask_for(OTTO, 0.0)
    with pytest.raises(ServerError, match="otto asks to take over already"):
        arbiter.ask_for(IDA, 1.0)
    with pytest.raises(ServerError, match="nobody asks you"):
        arbiter.give("o", give=True)
    arbiter.give("a", give=False)
    assert arbiter.commander is not None
    assert (arbiter.commander.driver, arbiter.wish) == (ANNA, None)
    arbiter.ask_for(OTTO, 2.0)
    arbiter.give("a", give=True)
    assert (arbiter.commander.driver, arbiter.wish) == (OTTO, None)
    with pytest.raises(ServerError, match="you drive already"):
        arbiter.ask_for(OTTO, 3.0)


def test_asking_again_wins_no_time() -> None:
    arbiter = commanded()
    arbiter.ask_for(OTTO, 0.0)
    arbiter.ask_for(OTTO, 4.0)
    assert not arbiter.tick(4.9)
    assert arbiter.tick(5.0)


def test_who_leaves_while_somebody_asks_hands_over() -> None:
    arbiter = commanded()
    arbiter.ask_for(OTTO, 0.0)
    assert arbiter.gone("a") is None
    assert arbiter.commander is not None
    assert arbiter.commander.driver == OTTO


STEPS = st.lists(
    st.tuples(
        st.sampled_from(["start", "began", "refused", "ended", "ask", "give", "keep", "gone", "tick", "silent"]),
        st.sampled_from([ANNA, OTTO, IDA]),
    ),
    max_size=40,
)


class Course:
    """An arbiter taken through steps, some of which it refuses."""

    def __init__(self) -> None:
        self.arbiter, self.number, self.is_starting = Arbiter(), 0, False
        self.stops: list[tuple[int, str | None]] = []

    def step(self, step: str, driver: Driver, now_s: float) -> None:
        match step:
            case "start":
                self.arbiter.start(driver)
                self.is_starting = True
            case "began" if self.is_starting:
                self.number, self.is_starting = self.number + 1, False
                self.arbiter.began(self.number, "drive", 0, attended=True)
            case "refused":
                self.arbiter.refused()
                self.is_starting = False
            case "ended":
                self.arbiter.ended(self.number)
            case "silent":
                self.stops.append((self.number, self.arbiter.to_stop(lambda _: 9.0, 1.5)))
            case _:
                self._hand_over(step, driver, now_s)

    def _hand_over(self, step: str, driver: Driver, now_s: float) -> None:
        match step:
            case "ask":
                self.arbiter.ask_for(driver, now_s)
            case "give" | "keep":
                self.arbiter.give(driver.browser, give=step == "give")
            case "tick":
                self.arbiter.tick(now_s)
            case "gone":
                self.stops.append((self.number, self.arbiter.gone(driver.browser)))


@given(STEPS)
def test_whatever_comes_there_is_one_commander_and_one_stop_a_mission(steps: list[tuple[str, Driver]]) -> None:
    course = Course()
    for now_s, (step, driver) in enumerate(steps):
        with contextlib.suppress(ServerError):
            course.step(step, driver, float(now_s))
        commander, wish = course.arbiter.commander, course.arbiter.wish
        assert not (course.is_starting and commander is not None)
        assert wish is None or (commander is not None and wish.driver != commander.driver)
    of_missions = [mission for mission, reason in course.stops if reason is not None]
    assert len(of_missions) == len(set(of_missions))


async def test_a_stop_is_said_again_each_tenth_of_a_second_until_it_is_answered() -> None:
    daemon = Daemon()

    async def late(request: Request[Any]) -> Any:
        await asyncio.sleep(0.35)
        return Done()

    daemon.answer = late
    took_s = await StopLine(daemon).stop("because")
    assert took_s == pytest.approx(0.35)
    assert daemon.times("stop") == pytest.approx([0.0, 0.1, 0.2, 0.3])


async def test_a_stop_that_nobody_confirms_is_an_error_after_three_seconds() -> None:
    daemon = Daemon()

    async def nobody(request: Request[Any]) -> Any:
        raise ServerError("no_daemon", "nothing was sent")

    daemon.answer = nobody
    line = StopLine(daemon)
    with pytest.raises(ServerError, match="emergency stop on the robot"):
        await line.stop("because")
    assert len(daemon.times("stop")) >= 25
    assert GIVEN_UP_S - 0.2 < daemon.times("stop")[-1] < GIVEN_UP_S
    assert (line.confirmed, line.unconfirmed) == (0, 1)


async def test_a_stop_goes_on_though_who_pressed_is_gone() -> None:
    daemon = Daemon()
    answered = asyncio.Event()

    async def late(request: Request[Any]) -> Any:
        await answered.wait()
        return Done()

    daemon.answer = late
    line = StopLine(daemon)
    pressing = asyncio.create_task(line.stop("because"))
    await asyncio.sleep(0.05)
    pressing.cancel()
    await asyncio.sleep(0.2)
    assert len(daemon.times("stop")) == 3
    answered.set()
    await asyncio.sleep(0.01)
    assert line.confirmed == 1


async def test_a_thousand_presses_are_bounded_and_all_are_answered() -> None:
    daemon = Daemon()

    async def late(request: Request[Any]) -> Any:
        await asyncio.sleep(0.05)
        return Done()

    daemon.answer = late
    line = StopLine(daemon)
    took = await asyncio.gather(*(line.stop("because") for _ in range(1000)))
    assert len(took) == 1000
    assert len(daemon.times("stop")) <= 40


def status(mode: str) -> Status:
    return Status(
        0,
        mode,
        "",
        (DeviceStatus("drive", LinkState.READY, armed=True, counters=()),),
        None,
        (),
        None,
        None,
        None,
        None,
    )


def test_a_robot_armed_here_and_left_idle_is_disarmed_once() -> None:
    idle = Idle(120.0)
    assert not idle.accept(status(Mode.IDLE), 0.0)
    assert not idle.accept(status(Mode.IDLE), 1000.0), "armed by somebody else"
    idle.armed(1000.0)
    assert not idle.accept(status(Mode.IDLE), 1119.0)
    assert not idle.accept(status("driving"), 1119.5)
    assert not idle.accept(status(Mode.IDLE), 1121.0), "it drove meanwhile"
    assert idle.accept(status(Mode.IDLE), 1241.0)
    assert not idle.accept(status(Mode.IDLE), 2000.0)
