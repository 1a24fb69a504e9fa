"""The first configuration of a robot: its three devices, every option of theirs as a comment, and what else was set."""

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

from robotd.core.bounds import Within, bounds_of
from robotd.hardware.devices.dialects import DIALECTS
from robotd.toml.writer import write_value

Values = Mapping[str, Mapping[str, object]]
"""By section and key."""


def starter_text(head: str, values: Values, remarks: Mapping[str, str] | None = None) -> str:
    """Return a configuration with these values; each device's section lists its dialects, and the options of its own.

    Args:
        head: the first line, a comment.
        values: what to set; a section ``drive``, ``pantilt`` or ``rangefinder`` may choose its ``dialect``. Of a
            device without values there is no section.
        remarks: on devices, a comment each: above its section, or in its place.
    """
    remarks = remarks or {}
    lines = [head, "# What is not here has its default; robotctl config show prints all of it."]
    for device in DIALECTS:
        remark = [f"# {remarks[device]}"] if device in remarks else []
        lines += ["", *remark, *(_device(device, dict(values[device])) if device in values else ())]
    for section, keys in values.items():
        if section not in DIALECTS:
            lines += ["", f"[{section}]", *(f"{key} = {write_value(value)}" for key, value in keys.items())]
    return "\n".join(lines) + "\n"


def _device(device: str, values: dict[str, object]) -> Iterable[str]:
    chosen = str(values.setdefault("dialect", "board"))
    yield f"[{device}]"
    yield f"# What it speaks; each dialect has options of its own. Known: {', '.join(DIALECTS[device])}."
    for name, dialect in DIALECTS[device].items():
        yield from (f"# {name}: {hazard}" for hazard in dialect.hazards)
        if name != chosen:
            yield f"# {name} has the options {', '.join(_options(dialect.options))}."
    # A dialect that there is none of is refused when the text is read.
    kind: Any = DIALECTS[device].get(chosen, DIALECTS[device]["board"]).options
    bounds = bounds_of(kind)
    yield f"dialect = {write_value(values.pop('dialect'))}"
    for field in dataclasses.fields(kind):
        if field.name == "dialect":
            continue
        said = values.pop(field.name, None)
        line = f"{field.name} = {write_value(field.default if said is None else said)}"
        meaning = _in_words(bounds[field.name]) if field.name in bounds else ""
        yield f"{'# ' if said is None else ''}{line}{meaning}"
    yield from (f"{key} = {write_value(value)}" for key, value in values.items())  # which loading will judge


def _options(kind: Any) -> Iterable[str]:
    return (field.name for field in dataclasses.fields(kind) if field.name not in {"dialect", "port", "line"})


def _in_words(bounds: Within) -> str:
    unit = "" if bounds.unit in {"", "of 1"} else f" {bounds.unit}"
    sign = ", of either sign" if bounds.either_sign else ""
    return f"  # {bounds.least:g} to {bounds.most:g}{unit}{sign}"
