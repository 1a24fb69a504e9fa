"""The command line as such: every verb explains itself, and every failure is one line and an exit code."""

import contextlib
import json
import re
import shlex
import socket
import subprocess
import sys
import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from robotd import __version__
from robotd.cli.main import WORDS, build_parser, main, verbs_of
from robotd.cli.verb import Verb
from robotd.cli.verbs.simulate import FIRMWARE
from robotd.cli.wheels import SOURCES
from robotd.core.errors import RequestTimeout, ServerError
from robotd.sim.emulators.catalogue import Firmware
from robotd.sim.recorded_robot import OdometrySource

VERBS = [verb for word in WORDS for verb in verbs_of(word)]


@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: verb.name)
def test_every_verb_explains_itself_with_an_example_that_parses(verb: Verb, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([*verb.name.split(), "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert left.value.code == 0
    assert f"Example: {verb.example}" in said
    assert "--json" in said
    assert ("--runtime-dir" in said) == verb.asks_daemon
    words = shlex.split(verb.example.partition(" > ")[0])
    assert words[: 1 + len(verb.name.split())] == ["robotctl", *verb.name.split()]
    assert build_parser(words[1:]).parse_args(words[1:]).run is verb.run


def test_every_word_says_what_its_verb_says_or_stands_for_a_family() -> None:
    every = {verb.name for module, _ in WORDS.values() for verb in import_module(f"robotd.cli.verbs.{module}").VERBS}
    assert every == {verb.name for verb in VERBS}
    alone = {verb.name: verb.summary for verb in VERBS if " " not in verb.name}
    assert {word: summary for word, (_, summary) in WORDS.items() if word in alone} == alone


def test_a_verb_waits_for_nothing_that_it_does_not_need() -> None:
    """The words of the command line are explained without the rest of the house, and a stop needs only a client."""
    for words, unwanted in (
        ("--help", "robotd.server"),
        ("stop --help", "robotd.sim"),
        ("stop --help", "robotd.config"),
    ):
        program = f"""
import sys
from robotd.cli.main import main
try:
    main({words.split()!r})
except SystemExit:
    print(*(name for name in sys.modules if name.startswith({unwanted!r})), file=sys.stderr)
"""
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        assert (done.stderr.split(), "usage: robotctl" in done.stdout) == ([], True)


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert (left.value.code, capsys.readouterr().out) == (0, f"robotctl {__version__}\n")


@pytest.mark.parametrize(
    "words",
    [
        ["jump"],
        ["map", "jump"],
        ["stop", "now"],
        ["localize", "--heading-unknwon"],
        ["map", "show", "--version", "new"],
        ["drive-to", "1"],
        ["drive-to", "1", "x"],
        ["status", "--timeout", "-1"],
        ["status", "--timeout", "nan"],
        ["watch", "moon"],
        ["map", "start", "a", "--legs", "wiggly"],
        ["map", "start", "a/b"],
        ["map", "start", "a", "--stop", "1", "nan"],
        ["map", "start", "a", "--start", "1", "inf", "0"],
        ["map", "show", "a", "--version", "-1"],
        ["map", "show", "--width", "0"],
        ["drive-to", "nan", "1"],
        ["drive"],
        ["drive", "11"],
        ["drive", "nan"],
        ["turn", "-3601"],
        ["localize", "--heading-deg", "inf"],
        ["sim", "--seeds", "0"],
    ],
)
def test_wrong_usage_is_exit_code_2(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(words)
    assert left.value.code == 2
    assert "usage: robotctl" in capsys.readouterr().err.lower()


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (
            "stauts",
            "robotctl: error: there is no robotctl stauts; did you mean status? (robotctl --help lists all verbs)",
        ),
        ("map sho", "robotctl map: error: there is no robotctl map sho; did you mean show?"),
        (
            "localize --heading-unknwon",
            "robotctl localize: error: --heading-unknwon means nothing here; did you mean --heading-unknown?",
        ),
        ("stop now", "robotctl stop: error: now means nothing here (robotctl stop --help lists what does)"),
        ("drive far", "robotctl drive: error: argument METRES: must be a number, got far"),
        ("sim --seeds few", "robotctl sim: error: argument --seeds: must be a whole number, got few"),
    ],
)
def test_wrong_usage_is_told_by_the_verb_that_was_meant_and_as_json_to_programs(
    typed: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*typed.split(), "--json"])
    captured = capsys.readouterr()
    assert said in captured.err
    assert said in json.loads(captured.out)["message"]
    assert json.loads(captured.out)["code"] == "wrong_usage"


@pytest.mark.parametrize("family", [(), ("map",), ("config",), ("calibrate",), ("record",)])
def test_without_a_verb_it_tells_which_there_are(family: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(family) == 0
    said = capsys.readouterr().out
    assert all(
        f"    {verb.name.split()[len(family)]} " in said
        for verb in VERBS
        if verb.name.split()[: len(family)] == [*family]
    )


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (ServerError("refused", "not armed"), "robotctl: refused: not armed"),
        (RequestTimeout("no answer from robotd"), "robotctl: no answer from robotd"),
    ],
)
def test_a_failure_is_one_line_and_exit_code_1(
    client: Any, error: Exception, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    client.raises = error
    assert main(["status"]) == 1
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", line + "\n")


def test_watching_nobody_is_a_failure(client: Any) -> None:
    client.raises = RequestTimeout("no answer from robotd")
    assert main(["watch"]) == 1


def test_who_is_not_in_the_group_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert main(["status", "--runtime-dir", str(tmp_path)]) == 1
    assert capsys.readouterr().err == (
        f"robotctl: {tmp_path}: permission denied: only members of its group may talk to robotd;"
        " join it, with: sudo usermod -aG robotd $USER, then log in again\n"
    )


@pytest.mark.parametrize("words", [["arm"], ["map", "list"], ["watch"], ["drive", "1"], ["calibrate", "heading"]])
@pytest.mark.parametrize("is_stale", [False, True])
def test_where_there_is_no_daemon_that_is_said_at_once_with_the_next_command(
    words: list[str], is_stale: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if is_stale:  # a daemon that was killed leaves its sockets behind
        with contextlib.closing(socket.socket(socket.AF_UNIX)) as left:
            left.bind(str(tmp_path / "commands.sock"))
    began_s = time.process_time()
    assert main([*words, "--runtime-dir", str(tmp_path)]) == 1
    assert time.process_time() - began_s < 1.0
    said = capsys.readouterr().err
    assert said.startswith(f"robotctl: no daemon in {tmp_path} ({'connection refused' if is_stale else 'there is no'}")
    assert "robotd --config FILE" in said
    assert "ROBOTD_RUNTIME_DIR" in said


def test_without_a_verb_it_explains_itself(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "map" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "meant"), [(["lokalize"], "localize"), (["map", "lst"], "list"), (["stopp"], "stop")]
)
def test_a_slip_is_told_with_what_was_meant(words: list[str], meant: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(words)
    assert f"did you mean {meant}?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code"),
    [(ServerError("refused", "not armed"), "refused"), (RequestTimeout("no answer"), "request_timeout")],
)
def test_errors_for_programs_are_objects(
    client: Any, error: Exception, code: str, capsys: pytest.CaptureFixture[str]
) -> None:
    client.raises = error
    assert main(["status", "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"code": code, "message": str(error)}


def test_the_words_for_odometry_and_boards_are_those_of_the_simulation() -> None:
    assert tuple(OdometrySource) == SOURCES
    assert tuple(Firmware) == FIRMWARE


def test_what_others_wrote_is_no_markup(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    status = replace(client.status(), reason="stopped by [/anybody] [red]")
    monkeypatch.setattr(client, "status", lambda: status)
    assert main(["status"]) == 0
    assert "stopped by [/anybody] [red]" in capsys.readouterr().out


def test_an_error_without_a_file_is_one_line_too(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(document: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("robotd.cli.verbs.status_and_arming.print_json", full)
    assert main(["status", "--json"]) == 1
    assert capsys.readouterr().err == "robotctl: No space left on device\n"


def test_the_timeout_and_the_directory_reach_the_client(monkeypatch: pytest.MonkeyPatch, client: Any) -> None:
    seen: list[Any] = []

    def connect(arguments: Any) -> Any:
        seen.append((str(arguments.runtime_dir), arguments.timeout))
        return client

    monkeypatch.setattr("robotd.cli.verbs.status_and_arming.connect", connect)
    assert main(["arm", "--runtime-dir", "there", "--timeout", "1.5"]) == 0
    assert main(["arm", "--runtime-dir", "there"]) == 0  # each request has its own time, saving a map a long one
    assert seen == [("there", 1.5), ("there", None)]


def test_status_for_people_and_for_programs(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["status"]) == 0
    said = capsys.readouterr().out
    for part in ("idle (armed by request)", "24.5 V", "pantilt", "absent", "frames 1203", "nothing"):
        assert part in said
    assert main(["status", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["event"], document["mode"], document["battery_v"]) == ("status", "idle", 24.5)
    assert [device["link"] for device in document["devices"]] == ["ready", "absent"]


def test_metrics_are_lines_that_a_collector_reads(client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["status", "--metrics"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert all(
        re.fullmatch(r'# (HELP|TYPE) robotd_\w+ .+|robotd_\w+(\{(\w+="[\w.+]+",?)+\})? -?[\d.e+]+', one)
        for one in lines
    )
    for line in (
        'robotd_mode{mode="idle"} 1',
        'robotd_mode{mode="fault"} 0',
        'robotd_device_ready{device="pantilt"} 0',
        'robotd_line_frames_total{line="drive"} 1203',
        "robotd_battery_volts 24.5",
        'robotd_missions_total{kind="map",end="done"} 2',
        "# TYPE robotd_loop_lag_seconds histogram",
        'robotd_loop_lag_seconds_bucket{le="0.0025"} 9',
        'robotd_loop_lag_seconds_bucket{le="+Inf"} 10',
        "robotd_loop_lag_seconds_count 10",
    ):
        assert line in lines


@pytest.mark.parametrize("verb", ["arm", "disarm", "clear"])
def test_a_switch_is_passed_on(client: Any, verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb]) == 0
    assert client.asked == [verb, "close"]
    assert main([verb, "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["mode"] == "idle"


def test_stop_says_who_stopped_it(client: Any) -> None:
    assert main(["stop"]) == 0
    assert client.asked[0] == ("stop", "stopped at the command line")


def test_colour_stays_out_of_pipes_and_away_if_unwanted(
    client: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["status"])
    assert "\x1b" not in capsys.readouterr().out
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("NO_COLOR", "1")
    main(["status"])
    assert "\x1b[3" not in capsys.readouterr().out


@pytest.mark.parametrize("words", [("map", "list"), ("localize",)])
def test_where_no_daemon_is_nobody_waits_for_what_it_takes_to_talk_to_one(words: tuple[str, ...]) -> None:
    script = (
        "import sys; from robotd.cli.main import main; code = main(sys.argv[1:]);"
        " print(code, *{'zmq', 'rich.progress', 'robotd.grid.kernels', 'robotd.maps.store'} & {*sys.modules})"
    )
    asked = [sys.executable, "-c", script, *words, "--runtime-dir", "/nowhere"]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    assert done.stdout == "1\n"
    assert "no daemon in /nowhere (there is no socket): start one" in done.stderr
