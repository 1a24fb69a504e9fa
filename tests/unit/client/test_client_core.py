"""The clients' common core, without a socket: repeats, deadlines, gaps, leases."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.client.exchange import UNREACHED_S, Exchanges
from robotd.client.feed import Feed, Gap, as_topics
from robotd.client.mission_run import MissionRun, final_estimate
from robotd.contract.answers import Done, MissionStarted, RecordingFile, Renewed
from robotd.contract.envelope import NumberedRequest, decode_request, encode_error, encode_result
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase, MissionProgress, Status, SweepProgress
from robotd.contract.request import Request
from robotd.contract.requests import Arm, GetStatus, Hello, RecordStop, Renew, Stop
from robotd.contract.topics import Frame, LogEntry, Topic, encode_frame, to_wire
from robotd.core.errors import MissionError, RemoteProtocolError, RequestTimeout, ServerError


def exchanges(deadline_s: float | None = None) -> Exchanges:
    return Exchanges("robotd in /here", retry_s=0.5, deadline_s=deadline_s)


def test_a_request_is_repeated_under_its_number_until_the_deadline() -> None:
    exchange = exchanges().begin(GetStatus(), 100.0)
    sent = [(now_s, exchange.due(now_s)) for now_s in (100.0, 100.2, 100.5, 100.9, 101.0)]
    assert [now_s for now_s, data in sent if data] == [100.0, 100.5, 101.0]
    assert len({data for _, data in sent if data}) == 1
    exchange.reached()
    exchange.due(100.0 + GetStatus.deadline_s - 0.1)
    with pytest.raises(RequestTimeout, match="status"):
        exchange.due(100.0 + GetStatus.deadline_s)


@pytest.mark.parametrize("request_", [GetStatus(), Renew(1), Arm(), Stop(), Hello()])
def test_a_daemon_that_is_there_is_given_ten_seconds_and_one_that_is_not_three(request_: Request[Any]) -> None:
    slow, absent, killed = (exchanges().begin(request_, 0.0) for _ in range(3))
    for exchange in (slow, killed):
        exchange.reached()
    killed.unreached(1.0)
    killed.unreached(2.0)
    given_s = {}
    for name, exchange in (("slow", slow), ("absent", absent), ("killed", killed)):
        with pytest.raises(RequestTimeout, match="no answer"):  # noqa: PT012  # it raises at a time, not in a call
            for tenths in range(200):
                given_s[name] = tenths / 10.0
                exchange.due(given_s[name])
    assert given_s == {"slow": 10.0, "absent": UNREACHED_S, "killed": 1.0 + UNREACHED_S}


def test_the_wait_ends_with_the_next_repeat_or_the_deadline() -> None:
    exchange = exchanges(deadline_s=0.7).begin(GetStatus(), 0.0)
    assert exchange.wait_s(0.0) == 0.0
    exchange.due(0.0)
    assert exchange.wait_s(0.1) == pytest.approx(0.4)
    exchange.due(0.5)
    assert exchange.wait_s(0.5) == pytest.approx(0.2)
    assert exchange.wait_s(9.0) == 0.0


def test_answers_find_their_requests_in_any_order() -> None:
    book = exchanges()
    first, second = book.begin(RecordStop(), 0.0), book.begin(RecordStop(), 0.0)
    book.accept(encode_result(second.id, RecordingFile("b")))
    assert (first.is_answered, second.is_answered) == (False, True)
    book.accept(encode_result(first.id, RecordingFile(None)))
    assert (first.result().path, second.result().path) == (None, "b")


def test_the_answer_to_a_repeat_is_let_go() -> None:
    book = exchanges()
    exchange = book.begin(Arm(), 0.0)
    book.accept(encode_result(exchange.id, Done()))
    book.end(exchange)
    assert book.accept(encode_result(exchange.id, Done())) is None


def test_a_refusal_is_raised_with_its_code() -> None:
    book = exchanges()
    exchange = book.begin(Arm(), 0.0)
    book.accept(encode_error(exchange.id, ServerError("refused", "a fault is latched")))
    with pytest.raises(ServerError, match="a fault is latched") as caught:
        exchange.result()
    assert caught.value.code == "refused"


def test_a_refusal_without_number_is_raised_at_once() -> None:
    with pytest.raises(ServerError, match="malformed"):
        exchanges().accept(encode_error(None, ServerError("malformed", "what?")))


def test_an_answer_of_another_shape_is_the_servers_fault() -> None:
    book = exchanges()
    exchange = book.begin(Hello(), 0.0)
    book.accept(encode_result(exchange.id, Done()))
    with pytest.raises(RemoteProtocolError, match="hello"):
        exchange.result()


def test_requests_are_numbered_apart() -> None:
    book = exchanges()
    sent = [decode_request(book.begin(Arm(), 0.0).due(0.0) or b"", 1000) for _ in range(3)]
    assert len({request.id for request in sent if isinstance(request, NumberedRequest)}) == 3


def frame(seq: int, session: str = "s", topic: Topic = Topic.LOG) -> bytes:
    return encode_frame(topic, session, seq, to_wire(LogEntry(seq, "INFO", "robotd", ""))[1])


def entry(seq: int) -> LogEntry:
    return LogEntry(seq, "INFO", "robotd", "")


def test_a_feed_may_begin_anywhere() -> None:
    assert Feed().accept(frame(17)) == [entry(17)]


def test_a_gap_is_announced_before_what_follows_it() -> None:
    feed = Feed()
    feed.accept(frame(1))
    assert feed.accept(frame(4)) == [Gap("log", 2), entry(4)]
    assert feed.accept(frame(5)) == [entry(5)]


def test_what_was_seen_is_not_told_again() -> None:
    feed = Feed()
    feed.accept(frame(3))
    assert feed.accept(frame(3)) == []
    assert feed.accept(frame(4)) == [entry(4)]


def counted(seq: int) -> bytes:
    """Of another event of the same topic."""
    fields = to_wire(SweepProgress(seq, 0, 1, 2, 1, 0, 0))[1]
    return encode_frame(Topic.LOG, "s", seq, fields)


def test_who_joins_is_told_the_last_of_each_event_and_each_is_news_once() -> None:
    feed = Feed()
    assert feed.accept(frame(9)) == [entry(9)]
    assert feed.accept(counted(4)) == [SweepProgress(4, 0, 1, 2, 1, 0, 0)]
    assert feed.accept(counted(4)) == []
    assert feed.accept(frame(9)) == []
    assert feed.accept(frame(10)) == [entry(10)]


def test_frames_are_sorted_as_they_are() -> None:
    feed = Feed()
    data = [frame(1), frame(1), frame(4), frame(0, "later"), encode_frame(Topic.LOG, "later", 1, {"event": "of then"})]
    sorted_ = [item for one in data for item in feed.sort(one)]
    assert [item.data for item in sorted_ if isinstance(item, Frame)] == [data[0], data[2], data[3], data[4]]
    assert [item for item in sorted_ if isinstance(item, Gap)] == [Gap("log", 2), Gap("log", None)]


def test_topics_are_counted_apart() -> None:
    feed = Feed()
    feed.accept(frame(3))
    assert feed.accept(frame(9, topic=Topic.STATUS)) == [entry(9)]


def test_a_new_daemon_is_a_gap_of_unknown_length() -> None:
    feed = Feed()
    feed.accept(frame(30))
    assert feed.accept(frame(0, "later")) == [Gap("log", None), entry(0)]


def test_an_unknown_event_still_counts() -> None:
    feed = Feed()
    feed.accept(frame(1))
    assert feed.accept(encode_frame(Topic.LOG, "s", 2, {"event": "of the future"})) == []
    assert feed.accept(frame(3)) == [entry(3)]


@given(st.lists(st.integers(0, 30), max_size=30))
@settings(max_examples=60)
def test_a_feed_is_increasing_and_its_gaps_add_up(numbers: list[int]) -> None:
    feed = Feed()
    seen: list[Any] = [item for seq in numbers for item in feed.accept(frame(seq))]
    told = [item.time_ns for item in seen if isinstance(item, LogEntry)]
    assert told == sorted(set(told))
    if told:
        missed = sum(item.missed or 0 for item in seen if isinstance(item, Gap))
        assert len(told) + missed == told[-1] - told[0] + 1


def test_no_topic_named_means_all() -> None:
    assert as_topics(()) == tuple(Topic)
    assert as_topics(("pose", "log")) == (Topic.POSE, Topic.LOG)
    with pytest.raises(ValueError, match="smell"):
        as_topics(("smell",))


def progress(phase: MissionPhase, mission_id: int = 7) -> MissionProgress:
    return MissionProgress(1, mission_id, "map", phase, 0, 1, "because")


def a_run() -> MissionRun:
    return MissionRun(MissionStarted(7, 0.4), 0.0)


def test_a_lease_is_renewed_well_before_it_runs_out() -> None:
    run, renewals, now_s = a_run(), 0, 0.0
    while now_s < 4.0:
        if run.is_due(now_s):
            run.renewed(Renewed(progress(MissionPhase.SWEEPING)), now_s)
            renewals += 1
        now_s += max(0.001, run.wait_s(now_s))
    assert 30 <= renewals <= 41


def test_a_mission_ends_with_its_own_message_only() -> None:
    run = a_run()
    told = [(run.accept(progress(MissionPhase.DONE, mission_id)), run.is_over) for mission_id in (6, 7)]
    assert told == [(None, False), (progress(MissionPhase.DONE), True)]
    run.check()


def test_what_was_published_before_the_mission_is_not_told() -> None:
    run, sweep = a_run(), SweepProgress(1, 0, 1, 3, 1, 0, 0)
    told = [run.accept(event) for event in (sweep, progress(MissionPhase.STARTED), sweep, entry(1), Gap("pose", 1))]
    assert told == [None, progress(MissionPhase.STARTED), sweep, None, None]


@pytest.mark.parametrize("phase", [MissionPhase.STOPPED, MissionPhase.FAILED])
def test_a_mission_that_was_not_done_says_why(phase: MissionPhase) -> None:
    run = a_run()
    run.accept(progress(phase))
    with pytest.raises(MissionError, match=f"map {phase}: because"):
        run.check()


def test_a_client_that_got_no_processor_says_that_its_lease_ended_for_that() -> None:
    run = MissionRun(MissionStarted(7, 0.4), 0.0)
    assert run.is_due(3.2)
    refused = run.refused(ServerError("refused", "mission 7 is not under way any more: the lease of mission 7 expired"))
    assert refused.code == "refused"
    assert "expired; this program renewed its lease of 0.4 s late by 3.1 s" in refused.message
    assert "continue with: robotctl arm" in refused.message
    run.accept(progress(MissionPhase.STOPPED))
    with pytest.raises(MissionError, match=r"because; this program renewed its lease of 0.4 s late by 3.1 s"):
        run.check()


def test_a_client_that_renewed_in_time_blames_nobody() -> None:
    run = MissionRun(MissionStarted(7, 0.4), 0.0)
    assert run.is_due(0.3)
    assert run.refused(ServerError("refused", "why")).message == "why"


def test_a_status_is_told_when_the_mission_is_held_and_when_it_goes_on() -> None:
    run = a_run()
    going, held, others = (status(7, None), status(7, "too busy"), status(6, "too busy"))
    assert run.accept(held) is None, "nothing is told before the mission's own first word"
    run.accept(progress(MissionPhase.STARTED))
    told = [run.accept(event) for event in (going, others, held, held, going, going)]
    assert told == [None, None, held, None, going, None]


def status(mission_id: int, held: str | None) -> Status:
    return Status(1, "mapping", "", (), None, (), mission_id, None, None, None, held)


def test_an_end_known_from_a_renewal_waits_for_messages_under_way_then_counts() -> None:
    run = a_run()
    run.renewed(Renewed(progress(MissionPhase.DONE)), 1.0)
    assert not run.is_due(9.0)
    told = [(run.overdue(now_s), run.is_over) for now_s in (1.1, 1.3, 1.4)]
    assert told == [(None, False), (progress(MissionPhase.DONE), True), (None, True)]


def test_only_a_final_estimate_is_an_answer() -> None:
    def estimate(state: PoseState, rank: int, *, final: bool) -> PoseEstimate:
        return PoseEstimate(1, state, None, (), rank, 300, final, "d")

    answer = estimate(PoseState.LOST, 2, final=True)
    others = [estimate(PoseState.LOCALIZED, 1, final=False), estimate(PoseState.PREDICTED, 3, final=True)]
    assert final_estimate([others[0], answer, others[1]]) is answer
    with pytest.raises(MissionError):
        final_estimate([*others])
