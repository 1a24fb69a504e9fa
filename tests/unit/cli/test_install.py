"""What systemd needs, put where it looks: ours replaced, the owner's kept, and nothing written that was only asked."""

import json
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.cli.service_files import Fate, service_files
from robotd.cli.verbs import install

PREFIX = "/usr/lib/robotd"
SHARED = {
    "man/man1/robotctl.1": ".TH",
    "bash-completion/completions/robotctl": "complete",
    "zsh/site-functions/_robotctl": "#compdef",
}
"""Of what a wheel brings; fonts and manuals of other packages lie beside it."""


@pytest.fixture(name="root")
def _root(tmp_path: Path) -> Path:
    program = tmp_path / PREFIX.lstrip("/") / "bin" / "robotd"
    program.parent.mkdir(parents=True)
    program.touch(0o755)
    for place, text in SHARED.items():
        file = program.parents[1] / "share" / place
        file.parent.mkdir(parents=True)
        file.write_text(text)
    return tmp_path


def installed(root: Path, *options: str) -> list[str]:
    return ["install", "--prefix", PREFIX, "--root", str(root), *options]


def test_everything_is_there_and_names_the_program(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(installed(root, "--dry-run", "--json")) == 0
    told = json.loads(capsys.readouterr().out)
    assert {one["fate"] for one in told} == {Fate.NEW}
    assert not (root / "etc").exists()
    assert main(installed(root)) == 0
    for name in ("systemd/system/robotd.service", "udev/rules.d/99-robotd.rules", "sysusers.d/robotd.conf"):
        assert (root / "etc" / name).read_text()
    assert "ExecStart=/usr/lib/robotd/bin/robotd\n" in (root / "etc/systemd/system/robotd.service").read_text()
    assert (root / "etc/robotd/robotd.toml").read_text() == (Path("systemd") / "robotd.toml").read_text()
    for place, text in SHARED.items():
        assert (root / "usr/local/share" / place).read_text() == text
    written = [file for name in ("etc", "usr/local") for file in (root / name).rglob("*") if file.is_file()]
    assert {str(one["file"]) for one in told} == {str(file) for file in written}


def test_a_manual_is_ours_to_replace_and_those_of_others_are_left(root: Path) -> None:
    share = root / PREFIX.lstrip("/") / "share/man/man1"
    (share / "ttx.1").write_text("of fonttools")
    (share / "robotctl.1").write_text("newer")
    page = root / "usr/local/share/man/man1/robotctl.1"
    page.parent.mkdir(parents=True)
    page.write_text("older")
    assert main(installed(root)) == 0
    assert [(file.name, file.read_text()) for file in page.parent.iterdir()] == [("robotctl.1", "newer")]


def test_what_the_owner_changed_is_kept_and_what_is_ours_replaced(root: Path) -> None:
    assert main(installed(root)) == 0
    config, unit = root / "etc/robotd/robotd.toml", root / "etc/systemd/system/robotd.service"
    config.write_text("# mine\n")
    unit.write_text("# mine\n")
    assert main(installed(root)) == 0
    assert config.read_text() == "# mine\n"
    assert "ExecStart=" in unit.read_text()
    fates = {file.path.name: file.fate for file in service_files(Path(PREFIX), root, None)}
    assert (fates["robotd.toml"], fates["robotd.service"]) == (Fate.KEPT, Fate.SAME)


def test_without_the_program_it_says_how_to_get_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(installed(tmp_path)) == 1
    assert f"python3 -m venv {PREFIX}" in capsys.readouterr().err


@pytest.mark.parametrize(("version", "has_steps"), [(252, False), (254, True), (None, True)])
def test_an_older_systemd_gets_no_words_that_it_does_not_know(version: int | None, has_steps: bool) -> None:
    (unit,) = [
        file for file in service_files(Path("/opt/robotd"), Path("/"), version) if file.path.name == "robotd.service"
    ]
    text = unit.content.decode()
    assert ("RestartSteps=" in text, "RestartMaxDelaySec=" in text) == (has_steps, has_steps)
    assert text.count("RestartSec=") == 1


@pytest.mark.parametrize(("known", "named"), [(None, True), ("/usr/bin/robotctl", False)])
def test_who_could_not_call_it_by_name_is_told_how(
    monkeypatch: pytest.MonkeyPatch, known: str | None, named: bool
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: known)
    said = install.linked(Path("/opt/robot d"))
    assert (said == ("ln -s '/opt/robot d/bin/robotctl' /usr/local/bin",)) == named
    assert bool(said) == named
