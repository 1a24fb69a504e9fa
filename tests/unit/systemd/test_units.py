"""The unit is tight, and its files agree with each other and with the configuration."""

import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "systemd"
SERVICE = FOLDER / "robotd.service"


def tool(name: str) -> str:
    found = shutil.which(name)
    if found is None and "CI" in os.environ:
        pytest.fail(f"{name} is not installed here, and what lands has to be judged by it")
    if found is None:
        pytest.skip(f"{name} is not installed here")
    return found


def run(*command: str) -> str:
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "SYSTEMD_COLORS": "0"}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def settings(path: Path = SERVICE) -> dict[str, list[str]]:
    """Every assignment of a unit, in order, by key."""
    found: dict[str, list[str]] = {}
    for line in path.read_text().splitlines():
        if "=" in line and not line.startswith("#"):
            key, _, value = line.partition("=")
            found.setdefault(key, []).append(value)
    return found


def test_systemd_finds_the_service_safe() -> None:
    report = run(tool("systemd-analyze"), "security", "--offline=true", str(SERVICE))
    match = re.search(r"Overall exposure level for robotd.service: ([0-9.]+)", report)
    assert match is not None
    assert float(match[1]) <= 0.5


def test_systemd_understands_every_line(tmp_path: Path) -> None:
    analyze = tool("systemd-analyze")
    version = int(run(analyze, "--version").split()[1])
    installed = tmp_path / "robotd.service"  # verify wants the program to exist
    installed.write_text(re.sub(r"(?m)^ExecStart=.*", "ExecStart=/bin/true", SERVICE.read_text()))
    complaints = run(analyze, "verify", "--man=no", str(installed)).splitlines()
    since_254 = ("RestartSteps", "RestartMaxDelaySec")
    unexpected = [line for line in complaints if version >= 254 or not any(key in line for key in since_254)]
    assert [line for line in unexpected if "robotd.service" in line] == []


def test_the_service_is_supervised_as_promised() -> None:
    keys = settings()
    assert keys["Type"] == ["notify"]
    assert keys["WatchdogSec"] == ["10s"]
    assert keys["Restart"] == ["on-failure"]
    assert keys["RestartPreventExitStatus"] == ["2 78"]
    assert keys["StartLimitIntervalSec"] == ["0"]


def test_one_unit_holds_one_main_process_and_its_children() -> None:
    """Only it is told to end, only it is heard, and only it is watched: it ends and watches its children itself."""
    keys = settings()
    assert len(keys["ExecStart"]) == 1
    assert (keys["KillMode"], keys["NotifyAccess"]) == (["mixed"], ["main"])
    assert keys["OOMPolicy"] == ["continue"], "a child that memory ran out for is started again"


def test_the_daemon_goes_before_others_and_its_children_may_give_that_up_and_their_files() -> None:
    keys = settings()
    assert (keys["Nice"], keys["CPUWeight"]) == (["-15"], ["1000"])
    allowed = " ".join(line for line in keys["SystemCallFilter"] if not line.startswith("~")).split()
    calls = {"setpriority", "sched_setscheduler", "setrlimit", "prlimit64"}
    assert calls | {f"landlock_{call}" for call in ("create_ruleset", "add_rule", "restrict_self")} <= set(allowed)


def test_the_daemon_reaches_serial_lines_and_unix_sockets_only() -> None:
    keys = settings()
    assert keys["DevicePolicy"] == ["closed"]
    assert keys["DeviceAllow"] == ["char-ttyUSB rw", "char-ttyACM rw"]
    assert keys["RestrictAddressFamilies"] == ["AF_UNIX"]
    assert keys["PrivateNetwork"] == ["yes"]


def test_directories_and_sockets_are_the_groups() -> None:
    keys = settings()
    assert (keys["RuntimeDirectory"], keys["RuntimeDirectoryMode"]) == (["robotd"], ["0750"])
    assert (keys["StateDirectory"], keys["UMask"]) == (["robotd"], ["0007"])


def test_the_user_exists_before_its_directories(tmp_path: Path) -> None:
    sysusers, tmpfiles = tool("systemd-sysusers"), tool("systemd-tmpfiles")
    if os.geteuid() != 0:
        pytest.skip("only root can make users and give directories away")
    (tmp_path / "etc").mkdir()
    run(sysusers, f"--root={tmp_path}", str(FOLDER / "robotd.sysusers.conf"))
    passwd = (tmp_path / "etc" / "passwd").read_text().split(":")
    assert (passwd[0], passwd[5]) == (settings()["User"][0], "/var/lib/robotd")
    run(tmpfiles, f"--root={tmp_path}", "--create", str(FOLDER / "robotd.tmpfiles.conf"))
    made = tmp_path / "var" / "lib" / "robotd" / "maps"
    assert (made.stat().st_mode & 0o777, made.stat().st_uid) == (0o750, int(passwd[2]))


RULES = [line for line in (FOLDER / "99-robotd.rules").read_text().splitlines() if line and not line.startswith("#")]


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_is_a_list_of_assignments(rule: str) -> None:
    item = r'[A-Z]+(\{\w+\})?(==|!=|\+=|=)"[^"]*"'
    assert re.fullmatch(rf"{item}(, {item})*", rule)


def test_every_jump_of_the_rules_has_its_label() -> None:
    text = "\n".join(RULES)
    assert set(re.findall(r'GOTO="(\w+)"', text)) == set(re.findall(r'LABEL="(\w+)"', text))


def test_the_rules_name_the_ports_of_the_configuration() -> None:
    config = tomllib.loads((FOLDER / "robotd.toml").read_text())
    ports = {config[device]["port"] for device in ("drive", "pantilt", "rangefinder")}
    assert {f"/dev/{name}" for name in re.findall(r'SYMLINK\+="([^"]+)"', "\n".join(RULES))} == ports


def test_the_rules_give_the_lines_to_the_user_of_the_service_alone() -> None:
    (rule,) = [rule for rule in RULES if "OWNER=" in rule]
    assert f'OWNER="{settings()["User"][0]}"' in rule
    assert f'GROUP="{settings()["Group"][0]}"' in rule
    assert 'MODE="0600"' in rule
    assert 'ENV{ID_MM_DEVICE_IGNORE}="1"' in rule


def test_the_rules_keep_brltty_from_the_boards_and_only_from_them() -> None:
    (rule,) = [rule for rule in RULES if "SYSTEMD_WANTS" in rule]
    assert 'SUBSYSTEM=="usb"' in rule
    before = RULES[: RULES.index(rule)]
    assert 'ENV{ROBOTD_BOARD}!="?*", GOTO="robotd_end"' in before
    assert len([one for one in before if "ID_SERIAL_SHORT" in one]) == 3
    assert not any("SYMLINK" in one for one in before), "the name is that of the line, not of the adapter"


def test_the_directories_are_those_of_the_configuration() -> None:
    config = tomllib.loads((FOLDER / "robotd.toml").read_text())
    assert config["server"]["runtime_dir"] == f"/run/{settings()['RuntimeDirectory'][0]}"
    made = (FOLDER / "robotd.tmpfiles.conf").read_text()
    for directory in (config["maps"]["dir"], config["recording"]["dir"]):
        assert directory in made
        assert directory.startswith(f"/var/lib/{settings()['StateDirectory'][0]}/")


GATEWAY = FOLDER / "robotd-gateway.service"


def test_systemd_finds_the_gateway_safe_though_browsers_reach_it() -> None:
    report = run(tool("systemd-analyze"), "security", "--offline=true", str(GATEWAY))
    match = re.search(r"Overall exposure level for robotd-gateway.service: ([0-9.]+)", report)
    assert match is not None
    assert float(match[1]) <= 1.0


def test_the_gateway_has_no_device_and_no_capability_and_never_goes_before_the_daemon() -> None:
    keys = settings(GATEWAY)
    assert (keys["PrivateDevices"], keys["CapabilityBoundingSet"]) == (["yes"], [""])
    assert (keys["User"], keys["SupplementaryGroups"]) == (["robotd-gateway"], ["robotd"])
    assert int(keys["Nice"][0]) > int(settings()["Nice"][0])
    assert keys["RestartPreventExitStatus"] == ["2 78"], "without a token it is not tried again"
    assert "RuntimeDirectory" not in keys
    port = tomllib.loads((FOLDER / "robotd-gateway.toml").read_text())["listen"]["port"]
    assert keys["SocketBindAllow"] == [f"tcp:{port}"]
