"""Write the tables of ``PROTOCOL.md`` and the C of the messages: ``python -m firmware_proto.generate [--check]``.

In the document, text between ``<!-- generated: NAME -->`` and ``<!-- end -->`` belongs to this program.
"""

import argparse
import ast
import enum
import inspect
import itertools
import re
import sys
import textwrap
from pathlib import Path

from firmware_proto import (
    c_devices,
    c_messages,
    common,
    drive_messages,
    framing,
    pantilt_messages,
    rangefinder_messages,
)
from firmware_proto.c_messages import Enum
from firmware_proto.common import BoardState
from firmware_proto.rules import RULES
from firmware_proto.schema import Message, Wire, payload_size, wire_fields

HERE = Path(__file__).parent

_MODULES = (common, drive_messages, pantilt_messages, rangefinder_messages)
_TYPES = {"B": ("u8", 1), "H": ("u16", 2), "h": ("i16", 2), "I": ("u32", 4), "i": ("i32", 4), "Q": ("u64", 8)}
_NUMBERS = {
    "PROTOCOL_MAJOR": common.PROTOCOL_MAJOR,
    "PROTOCOL_MINOR": common.PROTOCOL_MINOR,
    "DICTIONARY_CHUNK": common.DICTIONARY_CHUNK,
    "TTL_LIMIT_MS": drive_messages.TTL_LIMIT_MS,
    "PAYLOAD_MAX": framing.PAYLOAD_MAX,
    "PACKET_MAX": framing.PACKET_MAX,
}
"""What the C side needs besides messages and enumerations."""
_MARKED = re.compile(r"(<!-- generated: (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)


def main(arguments: list[str] | None = None) -> int:
    """Write what is stale, or with ``--check`` only say so; return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m firmware_proto.generate", description="Generate from the schema.")
    parser.add_argument("--check", action="store_true", help="write nothing; fail when a file is stale")
    check = parser.parse_args(arguments).check
    # All of them before any is written: the C is made of what its own file holds.
    stale = [(path, text) for path, text in outputs().items() if _text(path) != text]
    for path, text in stale:
        print(f"{path.name} {'is stale: run python -m firmware_proto.generate' if check else 'written'}")
        if not check:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return int(check and bool(stale))


def outputs() -> dict[Path, str]:
    """Return what each generated file should hold."""
    protocol, c = HERE / "PROTOCOL.md", HERE / "c"
    messages = tuple(message for module in _MODULES for message in module.MESSAGES)
    return {
        protocol: filled(_text(protocol)),
        c / "messages.h": c_messages.header(messages, declared_enums(), _NUMBERS),
        c / "messages.c": c_messages.source(messages),
        c / "devices.h": c_devices.header(),
        c / "devices.c": c_devices.source(_text(c / "devices.c")),
    }


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def filled(document: str) -> str:
    """Return a document with fresh text between its markers.

    Raises:
        KeyError: a marker names nothing that can be generated.
    """
    sections = _sections()
    return _MARKED.sub(lambda found: f"{found[1]}\n{sections[found[2]]}\n{found[3]}", document)


def _sections() -> dict[str, str]:
    names = [module.__name__.rpartition(".")[2].removesuffix("_messages") for module in _MODULES]
    messages = {f"messages-{name}": _messages(module.MESSAGES) for name, module in zip(names, _MODULES, strict=True)}
    return messages | {"requests": _requests(), "enums": "\n".join(_enum(one) for one in declared_enums())}


def _messages(messages: tuple[type[Message], ...]) -> str:
    return "\n".join(_message(message) for message in messages)


def _message(message: type[Message]) -> str:
    about = (
        f"#### `0x{message.TYPE:02X}` {message.__name__}\n\n{_plain(message)} Payload: {payload_size(message)} bytes.\n"
    )
    fields = wire_fields(message)
    return f"{about}\n{_field_table(fields)}" if fields else about


def _plain(declared: type) -> str:
    return inspect.cleandoc(declared.__doc__ or "").replace("``", "`")


def _field_table(fields: dict[str, Wire]) -> str:
    lines = ["| offset | type | field | unit | meaning |", "|---|---|---|---|---|"]
    offset = 0
    for name, wire in fields.items():
        kind, size = _TYPES.get(wire.code) or (f"{wire.code[:-1]} bytes", int(wire.code[:-1]))
        lines.append(f"| {offset} | {kind} | `{name}` | {wire.unit} | {wire.meaning} |")
        offset += size
    return "\n".join(lines) + "\n"


def _requests() -> str:
    states = " | ".join(state.name for state in BoardState)
    lines = [f"| type | request | {states} | deduplicated |", "|---|---|" + "---|" * (len(BoardState) + 1)]
    for request, rule in RULES.items():
        allowed = " | ".join("yes" if state in rule.states else "-" for state in BoardState)
        repeat = "yes" if rule.deduplicated else "no"
        lines.append(f"| `0x{request.TYPE:02X}` | {request.__name__} | {allowed} | {repeat} |")
    return "\n".join(lines) + "\n"


def declared_enums() -> list[Enum]:
    """Return the enumerations of the contract, module by module."""
    return [
        one
        for module in _MODULES
        for one in vars(module).values()
        if inspect.isclass(one) and issubclass(one, enum.IntEnum | enum.IntFlag) and one.__module__ == module.__name__
    ]


def _enum(one: Enum) -> str:
    notes = _member_notes(one)
    lines = [f"#### {one.__name__}", "", _plain(one), "", "| value | name | meaning |", "|---|---|---|"]
    lines += [f"| {member.value} | `{name}` | {notes[name]} |" for name, member in one.__members__.items()]
    return "\n".join(lines) + "\n"


def _member_notes(one: Enum) -> dict[str, str]:
    """Return the sentence written under each member."""
    (declaration,) = ast.parse(textwrap.dedent(inspect.getsource(one))).body
    statements = declaration.body if isinstance(declaration, ast.ClassDef) else []
    notes = {}
    for member, note in itertools.pairwise(statements):
        match member, note:
            case ast.Assign(targets=[ast.Name(id=name)]), ast.Expr(value=ast.Constant(value=str(text))):
                notes[name] = text.replace("``", "`")
    return notes


if __name__ == "__main__":
    sys.exit(main())
