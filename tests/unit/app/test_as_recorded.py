"""A recording from before a setting existed is replayed as things were then."""

from robotd.app.as_recorded import SINCE, recorded_config
from robotd.config import Config, effective_text
from robotd.grid.settings import BetweenBeams


def test_a_configuration_of_today_is_taken_as_it_is() -> None:
    assert recorded_config(effective_text(Config())) == Config()


def test_what_a_recording_lacks_is_as_it_was_before() -> None:
    text = "\n".join(
        line
        for line in effective_text(Config()).splitlines()
        if line.partition(" = ")[0] not in {key for section in SINCE.values() for key in section}
    )
    config = recorded_config(text)
    assert config.grid.between_beams is BetweenBeams.UNSEEN
    assert config.judgement.second_look.on_walls_min == 0.0


def test_what_a_recording_says_is_kept() -> None:
    text = effective_text(Config()).replace("on_walls_min = 0.9", "on_walls_min = 0.8")
    assert recorded_config(text).judgement.second_look.on_walls_min == 0.8


def test_every_setting_that_came_later_is_one() -> None:
    for section, keys in SINCE.items():
        for key in keys:
            assert f"\n{key} = " in effective_text(Config()).partition(f"[{section}]")[2]
