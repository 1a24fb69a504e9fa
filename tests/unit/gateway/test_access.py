"""Who may do what: tokens, sessions, roles, origins and limits, as tables."""

import stat
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.contract.requests import REQUESTS
from robotd.core.errors import ConfigError, ServerError
from robotd.gateway.access.audit import Audit
from robotd.gateway.access.origins import check_host, check_origin
from robotd.gateway.access.roles import Role, role_for
from robotd.gateway.access.sessions import MAY_STILL_STOP_S, MOST, Sessions
from robotd.gateway.access.tokens import SECRET_LENGTH, TokenError, TokenFile, Tokens, make_token
from robotd.gateway.access.visitor_limits import WRONG_TOKENS, Crowd, Rate, WrongTokens

HOUR_S = 3600.0


def test_a_secret_has_256_bits_and_is_not_kept(tmp_path: Path) -> None:
    secret, token = make_token("anna", Role.OPERATOR, 100.0)
    file = TokenFile(tmp_path / "state" / "tokens.json")
    file.write(Tokens((token,)))
    assert len(secret) == SECRET_LENGTH
    assert secret not in file.path.read_text()
    assert file.read() == Tokens((token,))
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600


def test_a_token_signs_in_until_it_is_over_revoked_or_used_up() -> None:
    secret, token = make_token("anna", Role.VIEWER, 100.0, lives_s=50.0, is_for_one_use=True)
    tokens = Tokens().with_new(token)
    assert tokens.match(secret, 149.0) == token
    assert tokens.match(secret, 150.0) is None
    assert tokens.match("another", 149.0) is None
    assert tokens.match("", 149.0) is None
    assert tokens.without("anna").match(secret, 149.0) is None
    used = tokens.with_used(token)
    assert used.match(secret, 149.0) is None
    assert used.match("", 149.0) is None
    assert not used.usable(149.0)
    assert used.named("anna") is not None


def test_names_of_tokens_are_unique() -> None:
    tokens = Tokens().with_new(make_token("anna", Role.VIEWER, 0.0)[1])
    with pytest.raises(TokenError, match="anna already"):
        tokens.with_new(make_token("anna", Role.ADMIN, 0.0)[1])
    with pytest.raises(TokenError, match="no token otto"):
        tokens.without("otto")


@pytest.mark.parametrize("text", ["", "{", "[1]", '[{"name": "a"}]', "\x00"])
def test_a_damaged_file_of_tokens_is_named(tmp_path: Path, text: str) -> None:
    file = TokenFile(tmp_path / "tokens.json")
    file.path.write_text(text)
    with pytest.raises(ConfigError, match=r"tokens\.json: not a file of tokens"):
        file.read()


def test_a_file_that_is_not_there_has_no_tokens(tmp_path: Path) -> None:
    assert TokenFile(tmp_path / "tokens.json").read() == Tokens()
    assert TokenFile(tmp_path / "tokens.json").mark() is None


@pytest.mark.parametrize(
    ("after_s", "stands", "may_stop"),
    [
        (0.0, True, True),
        (11.9 * HOUR_S, True, True),
        (12.0 * HOUR_S, False, True),
        (12.0 * HOUR_S + MAY_STILL_STOP_S - 1.0, False, True),
        (12.0 * HOUR_S + MAY_STILL_STOP_S, False, False),
        (-5000.0, True, True),  # the clock was set back
    ],
)
def test_a_session_idles_and_may_then_stop_for_a_day(after_s: float, stands: bool, may_stop: bool) -> None:
    sessions = Sessions(12.0 * HOUR_S)
    secret, _ = sessions.begin(make_token("anna", Role.VIEWER, 0.0)[1], 1e6)
    assert (sessions.may_stop(secret, 1e6 + after_s) is not None) == may_stop
    assert (sessions.find(secret, 1e6 + after_s) is not None) == stands


def test_a_session_ends_by_signing_out_and_with_its_token() -> None:
    sessions = Sessions(HOUR_S)
    _, anna = make_token("anna", Role.VIEWER, 0.0)
    _, otto = make_token("otto", Role.ADMIN, 0.0)
    first, one = sessions.begin(anna, 10.0)
    second, two = sessions.begin(otto, 10.0)
    sessions.end(one, 20.0)
    assert sessions.find(first, 21.0) is None
    assert sessions.may_stop(first, 21.0) is one
    assert sessions.end_revoked(Tokens((anna,)), 22.0) == [two]
    assert sessions.find(second, 22.0) is None
    again = make_token("otto", Role.VIEWER, 99.0)[1]
    third, _ = sessions.begin(otto, 10.0)
    assert sessions.end_revoked(Tokens((again,)), 100.0), "another token of the same name is another token"
    assert sessions.find(third, 100.0) is None


def test_sessions_outlive_a_restart_and_garbage_signs_nobody_in() -> None:
    sessions = Sessions(HOUR_S)
    secret, _ = sessions.begin(make_token("anna", Role.VIEWER, 0.0)[1], 10.0)
    kept = sessions.to_bytes(20.0)
    assert secret.encode() not in kept
    later = Sessions(HOUR_S)
    later.take(kept)
    assert later.find(secret, 30.0) is not None
    later.take(b"garbage")
    assert later.find(secret, 30.0) is not None
    assert Sessions(HOUR_S).find("", 30.0) is None


def test_sessions_are_bounded_and_the_oldest_goes() -> None:
    sessions = Sessions(HOUR_S)
    token = make_token("anna", Role.VIEWER, 0.0)[1]
    secrets = [sessions.begin(token, float(number))[0] for number in range(MOST + 1)]
    assert len(sessions.all) == MOST
    assert sessions.find(secrets[0], float(MOST)) is None
    assert sessions.find(secrets[-1], float(MOST)) is not None


def test_every_command_has_a_role_and_looking_needs_the_least() -> None:
    roles = {name: role_for(kind) for name, kind in REQUESTS.items()}
    assert {name for name, role in roles.items() if role is Role.VIEWER} == {
        name for name, kind in REQUESTS.items() if kind.only_looks
    }
    assert roles["arm"] is Role.OPERATOR
    assert all(role is Role.ADMIN for name, role in roles.items() if name.endswith("_delete"))


@pytest.mark.parametrize(
    ("host", "is_ours"),
    [
        ("127.0.0.1:8470", True),
        ("localhost", True),
        ("[::1]:8470", True),
        ("robot.lab:8470", True),
        ("ROBOT.lab", True),
        ("evil.example", False),
        ("127.0.0.1.evil.example", False),
        ("robot.lab.evil.example:8470", False),
        ("", False),
        (None, False),
    ],
)
def test_only_our_own_names_are_answered(host: str | None, is_ours: bool) -> None:
    if is_ours:
        check_host(host, ("robot.lab",))
        return
    with pytest.raises(ServerError, match="wrong_host"):
        check_host(host, ("robot.lab",))


@pytest.mark.parametrize(
    ("method", "is_socket", "headers", "is_ours"),
    [
        ("GET", False, {}, True),
        ("GET", True, {}, False),
        ("GET", True, {"Origin": "http://r:8470"}, True),
        ("POST", False, {"Origin": "http://r:8470"}, True),
        ("POST", False, {"Origin": "http://r:8470", "Sec-Fetch-Site": "same-origin"}, True),
        ("POST", False, {"Origin": "http://r:8470", "Sec-Fetch-Site": "cross-site"}, False),
        ("POST", False, {"Origin": "http://r:8470", "Sec-Fetch-Site": "same-site"}, False),
        ("POST", False, {"Origin": "https://r:8470"}, False),
        ("POST", False, {"Origin": "http://r:8471"}, False),
        ("POST", False, {"Origin": "http://evil"}, False),
        ("POST", False, {"Origin": "null"}, False),
        ("DELETE", False, {}, False),
    ],
)
def test_what_changes_something_comes_from_our_page(
    method: str, is_socket: bool, headers: dict[str, str], is_ours: bool
) -> None:
    told = {"Host": "r:8470", **headers}
    if is_ours:
        check_origin(method, told, "http", is_socket=is_socket)
        return
    with pytest.raises(ServerError, match="wrong_origin"):
        check_origin(method, told, "http", is_socket=is_socket)


def test_an_address_may_be_wrong_five_times_a_minute() -> None:
    wrong = WrongTokens()
    for second in range(WRONG_TOKENS):
        wrong.refuse("10.0.0.1", float(second))
        wrong.note("10.0.0.1", float(second))
    with pytest.raises(ServerError, match="wait 55 s"):
        wrong.refuse("10.0.0.1", 5.0)
    wrong.refuse("10.0.0.2", 5.0)
    wrong.refuse("10.0.0.1", 60.0)


def test_a_crowd_has_a_bound_and_so_has_each_session() -> None:
    crowd = Crowd(most=3, most_of_session=2)
    crowd.enter("a")
    crowd.enter("a")
    with pytest.raises(ServerError, match="this session has 2"):
        crowd.enter("a")
    crowd.enter("b")
    with pytest.raises(ServerError, match="3 connections are open"):
        crowd.enter("c")
    crowd.leave("a")
    crowd.enter("c")
    assert crowd.total == 3


@given(st.lists(st.floats(0.0, 0.5), min_size=1, max_size=200))
def test_a_rate_lets_no_more_pass_in_any_second_than_twice_its_bound(waits_s: list[float]) -> None:
    now_s, passed = 0.0, []
    rate = Rate(20.0, now_s)
    for wait_s in waits_s:
        now_s += wait_s
        if rate.take(now_s):
            passed.append(now_s)
    assert all(sum(begun <= at <= begun + 1.0 for at in passed) <= 40 for begun in passed)


def test_the_audit_is_bounded_and_printable() -> None:
    audit = Audit()
    for number in range(1500):
        audit.note(number, "anna\n", "10.0.0.1", "arm", "done")
    assert len(audit.all) == 1000
    assert "\n" not in audit.all[-1].who
