"""The table says what the theory above it promises."""

import itertools

from robotd.contract.modes import Mode
from robotd.mission.safety.mode_table import TRANSITIONS, Occasion, next_mode


def test_stop_and_device_loss_are_never_refused_and_always_disarm() -> None:
    for mode, occasion in itertools.product(Mode, (Occasion.STOP, Occasion.DEVICE_LOST)):
        expected = Mode.FAULT if mode is Mode.FAULT else Mode.DISARMED
        assert next_mode(mode, occasion) is expected


def test_a_fault_is_latched_from_everywhere() -> None:
    assert all(next_mode(mode, Occasion.FAULT) is Mode.FAULT for mode in Mode)
    leaving = {occasion for occasion in Occasion if next_mode(Mode.FAULT, occasion) not in {None, Mode.FAULT}}
    assert leaving == {Occasion.CLEAR}


def test_motion_is_only_entered_from_idle() -> None:
    ways = {(mode, occasion) for (mode, occasion), to in TRANSITIONS.items() if to is Mode.UNDER_WAY}
    assert ways == {(Mode.IDLE, Occasion.START)}


def test_idle_is_only_entered_by_arming_or_by_finishing() -> None:
    ways = {occasion for (mode, occasion), to in TRANSITIONS.items() if to is Mode.IDLE}
    assert ways == {Occasion.ARM, Occasion.FINISH}
    assert next_mode(Mode.DISARMED, Occasion.FINISH) is None
