"""The house stays readable: small files, small functions, nothing left lying about."""

import ast
import re
import statistics
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = sorted([*ROOT.glob("robotd/**/*.py"), *ROOT.glob("firmware_proto/**/*.py")])
TEXTS = sorted(
    path
    for pattern in ("robotd/**/*", "firmware_proto/**/*", "tests/**/*", "docs/**/*", "systemd/*", "*.md", "Makefile")
    for path in ROOT.glob(pattern)
    if path.suffix in {".py", ".md", ".toml", ".json", ".service", ".rules", ".conf", ""} and path.is_file()
)


def functions(path: Path) -> list[tuple[str, int]]:
    tree = ast.parse(path.read_text())
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    return [
        (f"{path.relative_to(ROOT)}:{node.lineno} {node.name}", (node.end_lineno or 0) - node.lineno + 1)
        for node in ast.walk(tree)
        if isinstance(node, kinds)
    ]


def test_no_file_is_over_400_lines_and_the_median_is_small() -> None:
    sizes = {path: len(path.read_text().splitlines()) for path in [*SOURCES, *ROOT.glob("tests/**/*.py")]}
    assert {str(path.relative_to(ROOT)): size for path, size in sizes.items() if size > 400} == {}
    assert statistics.median(sizes[path] for path in SOURCES) <= 120


def test_no_function_is_over_60_lines_and_most_are_short() -> None:
    sizes = [item for path in SOURCES for item in functions(path)]
    assert [item for item in sizes if item[1] > 60] == []
    lines = sorted(size for _, size in sizes)
    assert statistics.median(lines) <= 8
    assert lines[int(len(lines) * 0.9)] <= 30


@pytest.mark.parametrize("word", ["TODO", "FIXME", "XXX", "HACK"])
def test_nothing_is_left_for_later(word: str) -> None:
    this = Path(__file__)
    found = [
        str(path.relative_to(ROOT)) for path in TEXTS if path != this and re.search(rf"\b{word}\b", path.read_text())
    ]
    assert found == []


def test_every_ignore_says_why() -> None:
    silent = re.compile(r"#\s*(noqa|type:\s*ignore)(?!.*#.*#)(?!.*\]\s+#\s*\w)(?!.*:\s*[A-Z0-9, ]+\s+#\s*\w)")
    found = [
        f"{path.relative_to(ROOT)}:{number}"
        for path in [*SOURCES, *ROOT.glob("tests/**/*.py")]
        if path != Path(__file__)
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if silent.search(line)
    ]
    assert found == []
