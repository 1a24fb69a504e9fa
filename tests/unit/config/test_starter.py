"""A first configuration: good for every dialect, with all that can be set beside it as comments."""

import dataclasses
import re
from typing import Any, cast

import pytest

from robotd.config import Config, loads
from robotd.config.starter import starter_text
from robotd.core.errors import ConfigError
from robotd.hardware.devices.dialects import DIALECTS, MOTORLESS, SCANNERS

EVERY = [(device, dialect) for device, table in DIALECTS.items() for dialect in table]


def values(device: str, dialect: str) -> dict[str, dict[str, object]]:
    chosen: dict[str, dict[str, object]] = {name: {"port": f"/dev/tty{name}"} for name in DIALECTS}
    chosen[device]["dialect"] = dialect
    if dialect == MOTORLESS or dialect in SCANNERS:  # these two need each other
        chosen["pantilt"]["dialect"], chosen["rangefinder"]["dialect"] = MOTORLESS, SCANNERS[0]
    return chosen


@pytest.mark.parametrize(("device", "dialect"), EVERY)
def test_it_is_good_and_names_every_dialect_and_option(device: str, dialect: str) -> None:
    text = starter_text("# ours", values(device, dialect))
    config = loads(text)
    assert getattr(config, device).dialect == dialect
    section = text.partition(f"[{device}]")[2].partition("\n[")[0]
    for name, row in DIALECTS[device].items():
        assert name in section
        assert all(hazard in section for hazard in row.hazards)
    for field in dataclasses.fields(cast("Any", DIALECTS[device][dialect].options)):
        assert re.search(rf"^(# )?{field.name} = ", section, re.MULTILINE)


def test_the_comments_are_the_defaults() -> None:
    text = starter_text("# ours", {device: {} for device in DIALECTS})
    uncommented = "\n".join(line.removeprefix("# ") if " = " in line else line for line in text.splitlines())
    assert loads(uncommented) == Config()


def test_what_is_set_beside_is_there_and_judged() -> None:
    text = starter_text("# ours", {"drive": {"counts_per_m": 25_000.0, "nonsense": 1}, "maps": {"keep": 3}})
    with pytest.raises(ConfigError, match="nonsense"):
        loads(text)
    good = loads(text.replace("nonsense = 1\n", ""))
    assert (good.drive.counts_per_m, good.maps.keep) == (25_000.0, 3)
