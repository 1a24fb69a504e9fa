"""Every Sphinx role in a docstring names something that is there: it resolves by import."""

import ast
import functools
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
FILES = sorted(file for room in ("robotd", "firmware_proto") for file in (ROOT / room).rglob("*.py"))
_ROLE = re.compile(r":(?:mod|class|func|meth|data|attr|exc):`~?([^`<>]+)`")


def dotted(file: Path) -> str:
    """Return the name under which a file is imported."""
    return ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


@functools.cache
def is_there(name: str) -> bool:
    """Whether a module, or something in one, has this full name."""
    words = name.split(".")
    for count in range(len(words), 0, -1):
        try:
            found: object = importlib.import_module(".".join(words[:count]))
        except ImportError:
            continue
        for word in words[count:]:
            if word in getattr(found, "__annotations__", {}) and not hasattr(found, word):
                return True
            if not hasattr(found, word):
                return False
            found = getattr(found, word)
        return True
    return False


@functools.cache
def full_names() -> frozenset[str]:
    """Return what the package defines: modules, functions and classes in them, methods and fields in those."""
    names = set()
    for file in FILES:
        module = dotted(file)
        names.add(module)
        for name, node in defined(ast.parse(file.read_text())):
            names.add(f"{module}.{name}")
            names |= {f"{module}.{name}.{part}" for part, _ in defined(node) if isinstance(node, ast.ClassDef)}
    return frozenset(names)


def defined(scope: ast.Module | ast.stmt) -> Iterator[tuple[str, ast.stmt]]:
    """Yield what a module or a class defines, by name."""
    for node in getattr(scope, "body", ()):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name, node
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id, node


def resolves(target: str, file: Path) -> bool:
    """Whether a role resolves where it stands: a full name, one in module or class, or ``.the.end`` of one."""
    if target.startswith("."):
        return any(name.endswith(target) and is_there(name) for name in full_names())
    return any(is_there(f"{scope}{target}") for scope in ("", *scopes(file)))


@functools.cache
def scopes(file: Path) -> tuple[str, ...]:
    """Return what a name in a file may be short of: its module, or a class in it."""
    module = dotted(file)
    classes = [node.name for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ClassDef)]
    return (f"{module}.", *(f"{module}.{one}." for one in classes))


def test_roles_are_found() -> None:
    assert sum(len(_ROLE.findall(file.read_text())) for file in FILES) > 200


def test_every_role_resolves() -> None:
    lost = {
        str(file.relative_to(ROOT)): names
        for file in FILES
        if (names := [name for name in _ROLE.findall(file.read_text()) if not resolves(name.removesuffix("()"), file)])
    }
    assert lost == {}


def test_a_role_that_names_nothing_does_not_resolve() -> None:
    here = ROOT / "robotd/core/pose.py"
    assert resolves("Pose2", here)
    assert resolves("robotd.core.pose.Pose2.transform", here)
    assert resolves(".pose", here)
    assert not resolves("Pose3", here)
    assert not resolves("robotd.core.pose.Pose2.nothing", here)
    assert not resolves(".no_such_thing", here)
