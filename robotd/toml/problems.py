"""What is wrong with a configuration, each with its place and, where one is near, the name that was meant."""

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from robotd.core.errors import ConfigError
from robotd.toml.lines import KeyPath, line_of

UNITS = {
    "m": "metres",
    "cm": "centimetres",
    "mm": "millimetres",
    "km": "kilometres",
    "rad": "radians",
    "deg": "degrees",
    "degrees": "degrees",
    "s": "seconds",
    "sec": "seconds",
    "ms": "milliseconds",
    "us": "microseconds",
    "ns": "nanoseconds",
    "hz": "hertz",
    "khz": "kilohertz",
    "mps": "metres per second",
    "mps2": "metres per second squared",
    "mmps": "millimetres per second",
    "kmh": "kilometres per hour",
    "radps": "radians per second",
    "radps2": "radians per second squared",
    "dps": "degrees per second",
    "degps": "degrees per second",
    "rpm": "turns per minute",
    "v": "volts",
    "mv": "millivolts",
    "counts": "encoder counts",
    "cells": "grid cells",
    "bytes": "bytes",
    "kib": "kibibytes",
    "mib": "mebibytes",
    "baud": "baud",
}

_UNIT = "|".join(sorted(UNITS, key=len, reverse=True))
_NAME = re.compile(rf"(?P<stem>.+?)(?:_(?P<unit>(?:per_)?(?:{_UNIT})))?")


@dataclass(slots=True)
class Problems:
    """The problems of one text, in the order of their lines."""

    file: str
    lines: dict[KeyPath, int]
    found: list[ConfigError] = field(default_factory=list)
    broken: set[KeyPath] = field(default_factory=set)
    """Keys that have a problem: their values are not what the text says, and no more is said of them."""

    def add(self, path: KeyPath, message: str) -> None:
        """Note a problem with a key; ``stops_m[2]`` stands where ``stops_m`` stands."""
        self.broken.add(path)
        line = line_of(self.lines, tuple(part.partition("[")[0] for part in path))
        self.found.append(ConfigError(message, file=self.file, line=line, key=".".join(path)))

    def are_about(self, path: KeyPath) -> bool:
        """Return whether a problem with this key, or with what it lies in, is known."""
        return any(path[:length] in self.broken for length in range(1, len(path) + 1))

    def sorted(self) -> tuple[ConfigError, ...]:
        """Return the problems by line; those that have none come last."""
        return tuple(sorted(self.found, key=lambda problem: (problem.line is None, problem.line or 0)))


def unknown_name(kind: str, name: str, known: Iterable[str]) -> str:
    """Return the complaint about an unknown name: its unit if that is all that is wrong, else the nearest name.

    >>> unknown_name("key", "timeout_ms", ["timeout_s", "retries"])
    'wrong unit: expected timeout_s, in seconds'
    >>> unknown_name("key", "timeout", ["timeout_s"])
    'no unit: expected timeout_s, in seconds'
    >>> unknown_name("key", "retires", ["timeout_s", "retries"])
    'unknown key; did you mean retries?'
    """
    known = list(known)
    stem, unit = _split(name)
    for candidate in known:
        candidate_stem, candidate_unit = _split(candidate)
        if candidate_stem == stem and candidate_unit and candidate_unit != unit:
            return f"{'wrong' if unit else 'no'} unit: expected {candidate}, {_spell(candidate_unit)}"
    return f"unknown {kind}{did_you_mean(name, known)}"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean x?"`` with the nearest known name, or nothing if none is near."""
    near = difflib.get_close_matches(name, list(known), n=1, cutoff=0.55)
    return f"; did you mean {near[0]}?" if near else ""


def _split(name: str) -> tuple[str, str]:
    """Return ``(stem, unit)`` of a key; the unit is empty if the name ends with none."""
    match = _NAME.fullmatch(name)
    return (match["stem"], match["unit"] or "") if match else (name, "")


def _spell(unit: str) -> str:
    """Return a unit in words: ``in seconds``, ``per metre``."""
    if unit.startswith("per_"):
        return "per " + UNITS[unit.removeprefix("per_")].removesuffix("s")
    return f"in {UNITS[unit]}"
