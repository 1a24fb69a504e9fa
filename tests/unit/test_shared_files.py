"""What a wheel brings for a system's share: manuals and completions that know every verb and option."""

import importlib.util
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from robotd.cli.main import WORDS, verbs_of

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def shared() -> dict[str, str]:
    spec = importlib.util.spec_from_file_location("shared", ROOT / "systemd" / "wheel" / "shared.py")
    assert spec is not None
    assert spec.loader is not None
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    return dict(maker.shared())


def test_each_program_has_a_manual_and_completions(shared: dict[str, str]) -> None:
    programs = ("robotctl", "robotd", "robotd-gateway")
    places = ("man/man1/{}.1", "bash-completion/completions/{}", "zsh/site-functions/_{}")
    assert shared.keys() == {place.format(program) for program in programs for place in places}


def test_the_manual_has_a_section_for_every_verb_and_nothing_that_man_would_take_for_an_order(
    shared: dict[str, str],
) -> None:
    page = shared["man/man1/robotctl.1"]
    verbs = {verb.name for word in WORDS for verb in verbs_of(word)}
    assert {name.lower() for name in re.findall(r'^\.SH "(.*)"$', page, re.MULTILINE)} == verbs
    assert page.count("Example: robotctl ") == len(verbs)
    orders = {line.split()[0] for line in page.splitlines() if line.startswith((".", "'"))}
    assert orders == {".TH", ".SH", ".nf", ".fi"}


def test_the_completions_know_words_options_and_choices_and_bash_can_read_them(shared: dict[str, str]) -> None:
    script = shared["bash-completion/completions/robotctl"]
    for word in (*WORDS, "--heading-unknown", "--json", "rwi-ascii", "trinary"):
        assert word in script
        assert word in shared["zsh/site-functions/_robotctl"]
    bash = shutil.which("bash")
    if bash is not None:
        # What bash itself offers after "robotctl map de".
        asked = (
            f"{script}\nCOMP_WORDS=(robotctl map de); COMP_CWORD=2; COMP_LINE='robotctl map de'\n"
            "_shtab_robotctl; printf '%s\\n' \"${COMPREPLY[@]}\""
        )
        said = subprocess.run([bash, "-c", asked], capture_output=True, text=True, check=True).stdout
        assert said.split() == ["delete"]
