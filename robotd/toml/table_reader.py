"""From TOML values to frozen dataclasses, whatever they are; every problem is found, not only the first.

A dataclass is a table, its fields are the keys. Field types are bool, int, float, str, an enum, ``T | None``,
``tuple[T, ...]``, ``tuple[A, B]`` and further dataclasses; numbers may have bounds (:mod:`robotd.core.bounds`). A
``ValueError`` of ``__post_init__`` that begins with, or mentions, the name of a field is laid at that key's door.
"""

import contextlib
import dataclasses
import enum
import math
import re
import types
import typing
from typing import Annotated, Any, Generic, TypeVar, cast

from robotd.core.bounds import Within, bounds_in
from robotd.toml.chosen import ChosenBy, chosen_in
from robotd.toml.lines import KeyPath
from robotd.toml.problems import Problems, did_you_mean, unknown_name

T = TypeVar("T")
Table = dict[str, Any]

_NAMES = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_EXPECTED = {bool: "true or false", int: "a whole number", float: "a number", str: "a string"}


class Bad(Exception):  # a signal between the readers, never an error that leaves them
    """A value that could not be read; what is wrong with it is among the problems."""


@dataclasses.dataclass(frozen=True, slots=True)
class _Shape(Generic[T]):
    """The keys of a table: their types, and what they are if the text leaves them out."""

    kind: type[T]
    types: dict[str, Any]
    defaults: Table

    @classmethod
    def of(cls, kind: type[T], base: T | None) -> "_Shape[T]":
        fields = dataclasses.fields(cast("Any", kind))
        hints = typing.get_type_hints(kind, include_extras=True)
        types_of = {item.name: hints[item.name] for item in fields}
        if base is not None:
            return cls(kind, types_of, {name: getattr(base, name) for name in types_of})
        defaults = {item.name: item.default for item in fields if item.default is not dataclasses.MISSING}
        made = {item.name: item.default_factory() for item in fields if item.default_factory is not dataclasses.MISSING}
        return cls(kind, types_of, {**defaults, **made})


def read_table(kind: type[T], table: Table, path: KeyPath, problems: Problems, base: T | None = None) -> T:
    """Return the dataclass ``kind`` filled from a table, and from ``base``, or its defaults, for what is not there.

    All that is wrong with the table is added to ``problems``. What has a problem is as if it were not there: so that
    what surrounds the table can be judged all the same.

    Raises:
        Bad: it cannot be made even so.
    """
    shape = _Shape.of(kind, base)
    values = _read_known(shape, table, path, problems)
    for name in (name for name in table if name not in shape.types):
        problems.add((*path, name), unknown_name("key" if path else "section", name, shape.types))
    made = _construct(shape, values, path, problems)
    if made is None:
        raise Bad
    return made


def _read_known(shape: _Shape[T], table: Table, path: KeyPath, problems: Problems) -> Table:
    """Return the values that could be read; a required table that the text leaves out is read as an empty one."""
    values: Table = {}
    for name, kind in shape.types.items():
        default = shape.defaults.get(name)
        if name not in table and name in shape.defaults:
            continue
        if name not in table and not dataclasses.is_dataclass(kind):
            problems.add((*path, name), "required key is missing")
            continue
        with contextlib.suppress(Bad):
            values[name] = read_value(kind, table.get(name, {}), (*path, name), problems, default)
    return values


def _construct(shape: _Shape[T], values: Table, path: KeyPath, problems: Problems) -> T | None:
    """Return the object, or None if it cannot be made; every impossible value is reported.

    A value refused is put back to its default and the rest is tried again: so one mistake does not hide
    the next. A complaint that speaks of a value already known to be broken is not repeated.
    """
    while shape.types.keys() <= (shape.defaults | values).keys():
        try:
            return shape.kind(**(shape.defaults | values))
        except ValueError as error:
            message = str(error)
        names = [name for name in _NAMES.findall(message) if name.split(".")[0] in shape.types]
        if not any(problems.are_about((*path, *name.split("."))) for name in names):
            names = [_blame(message, names, path, problems), *names]
        if not any(_put_back(shape, values, name.split(".")) for name in names):
            return None
    return None


def _put_back(shape: _Shape[T], values: Table, key: list[str]) -> bool:
    """Give a key its default; return whether it had another value."""
    section, default = values.get(key[0]), shape.defaults.get(key[0])
    if key[0] not in values:
        return False
    if dataclasses.is_dataclass(default) and type(section) is not type(default):
        section, default = _as_kin(section, default, shape.types[key[0]], key[1:])
    if len(key) == 1 or default is None or getattr(section, key[1], None) == getattr(default, key[1], None):
        return len(key) == 1 and values.pop(key[0]) is not None
    try:
        values[key[0]] = dataclasses.replace(cast("Any", section), **{key[1]: getattr(default, key[1])})
    except ValueError:  # the default does not go with the rest of the section
        del values[key[0]]
    return True


def _as_kin(section: Any, default: Any, hint: Any, key: list[str]) -> tuple[Any, Any]:
    """Return a section that was chosen and its default, as one of a kind.

    If what it was chosen by is put back, it becomes of the default's kind, with what both kinds know.
    """
    choice = chosen_in(hint)
    if choice is None or key != [choice.key]:
        return section, type(section)()
    known = {item.name for item in dataclasses.fields(default)} & {item.name for item in dataclasses.fields(section)}
    return dataclasses.replace(default, **{name: getattr(section, name) for name in known}), default


def _blame(message: str, names: list[str], path: KeyPath, problems: Problems) -> str:
    """Report a refusal at the first key it mentions that the text sets, and return that key."""
    paths = [(*path, *name.split(".")) for name in names]
    set_here = [candidate for candidate in paths if candidate in problems.lines]
    key = (set_here or paths or [path])[0]
    if names and message.startswith(f"{names[0]} ") and key == paths[0]:
        message = message.removeprefix(f"{names[0]} ")
    problems.add(key, message)
    return ".".join(key[len(path) :])


def read_value(kind: Any, value: object, path: KeyPath, problems: Problems, default: Any = None) -> Any:
    """Return a TOML value as ``kind``; a table takes from ``default`` what it leaves out.

    Raises:
        Bad: it is not one; why was added to ``problems``.
    """
    if typing.get_origin(kind) is Annotated:
        return _read_annotated(kind, value, path, problems, default)
    if dataclasses.is_dataclass(kind):
        if not isinstance(value, dict):
            raise _bad(path, problems, f"expected a table, got {_describe(value)}")
        return read_table(cast("type[Any]", kind), value, path, problems, default)
    if isinstance(kind, types.UnionType) or typing.get_origin(kind) is typing.Union:
        [inner] = [option for option in typing.get_args(kind) if option is not types.NoneType]
        return read_value(inner, value, path, problems, default)
    if typing.get_origin(kind) is tuple:
        return _read_tuple(typing.get_args(kind), value, path, problems)
    if issubclass(kind, enum.Enum):
        return _read_enum(kind, value, path, problems)
    return _read_plain(kind, value, path, problems)


def _read_annotated(kind: Any, value: object, path: KeyPath, problems: Problems, default: Any) -> Any:
    choice = chosen_in(kind)
    if choice is not None:
        return _read_chosen(choice, value, path, problems, default)
    read = read_value(typing.get_args(kind)[0], value, path, problems, default)
    return _read_within(bounds_in(kind), read, path, problems, default)


def _read_chosen(choice: ChosenBy, value: object, path: KeyPath, problems: Problems, default: Any) -> Any:
    """Return a table as the dataclass that one of its keys chooses.

    Options of the others are refused, unless they say their default: configurations that say everything stay valid.
    """
    if not isinstance(value, dict):
        raise _bad(path, problems, f"expected a table, got {_describe(value)}")
    word = value.get(choice.key, getattr(default, choice.key))
    # With a word that chooses nothing the rest is judged as the default's kind: more than one mistake may be found.
    kind = choice.kind(word) or type(default)
    own = {item.name for item in dataclasses.fields(kind)}
    table: Table = {}
    for name, said in value.items():
        owners = {} if name in own else choice.owners(name)
        if not owners:
            table[name] = said
        elif choice.kind(word) is not None and said not in owners.values():
            others = f"{choice.key} {', '.join(owners)}"
            problems.add((*path, name), f'is an option of {others}, and not of "{word}": leave it out')
    return read_table(kind, table, path, problems, default if type(default) is kind else None)


def _read_within(bounds: Within | None, value: Any, path: KeyPath, problems: Problems, default: Any) -> Any:
    complaint = None if bounds is None else bounds.complaint(value, default)
    if complaint is not None:
        raise _bad(path, problems, complaint)
    return value


def _read_tuple(kinds: tuple[Any, ...], value: object, path: KeyPath, problems: Problems) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise _bad(path, problems, f"expected a list, got {_describe(value)}")
    if kinds[-1] is Ellipsis:
        kinds = (kinds[0],) * len(value)
    if len(kinds) != len(value):
        raise _bad(path, problems, f"expected a list of {len(kinds)}, got {len(value)}")
    items: list[Any] = []
    for index, (kind, item) in enumerate(zip(kinds, value, strict=True)):
        with contextlib.suppress(Bad):
            items.append(read_value(kind, item, (*path[:-1], f"{path[-1]}[{index}]"), problems))
    if len(items) < len(value):
        raise Bad
    return tuple(items)


def _read_enum(kind: type[enum.Enum], value: object, path: KeyPath, problems: Problems) -> enum.Enum:
    by_value = {member.value: member for member in kind}
    if isinstance(value, str) and value in by_value:
        return by_value[value]
    shown = f'"{value}"{did_you_mean(value, by_value)}' if isinstance(value, str) else _describe(value)
    raise _bad(path, problems, f"expected one of {', '.join(by_value)}; got {shown}")


def _read_plain(kind: type[Any], value: object, path: KeyPath, problems: Problems) -> Any:
    # TOML tells 1 from 1.0; people do not.
    if kind is float and type(value) is int:
        value = float(value)
    # Not isinstance: to Python true is a whole number.
    if type(value) is not kind:
        raise _bad(path, problems, f"expected {_EXPECTED[kind]}, got {_describe(value)}")
    if isinstance(value, float) and not math.isfinite(value):
        raise _bad(path, problems, f"must be finite, got {value}")
    if isinstance(value, str) and "\0" in value:
        raise _bad(path, problems, "must not contain a zero byte")
    return value


def _bad(path: KeyPath, problems: Problems, message: str) -> Bad:
    problems.add(path, message)
    return Bad()


def _describe(value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return "a string"
        case int() | float():
            return f"the number {value}"
        case list():
            return "a list"
        case dict():
            return "a table"
        case _:
            return "a date or time"
