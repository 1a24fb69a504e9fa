"""What no program reaches stands on a shelf that says so; all else in the package is there for a program to run."""

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from robotd.cli.main import WORDS

ROOT = Path(__file__).parents[2]
SHELF = "robotd.localization.reference"
"""What tests, benchmarks and studies hold the engine against."""
ON_THE_SHELF = {
    "count_all",
    "directional_flood",
    "feasible_poses",
    "flooded_poses",
    "floods",
    "pixelized_vector",
    "probe",
    "rank",
    "smallest_error",
}
TWINS_ELSEWHERE = {"robotd.exact.pairwise"}
"""The slow twin of the plane sweep stands beside it."""
PROGRAMS = {
    "robotd.app.daemon",
    "robotd.cli.main",
    "robotd.client",
    "robotd.library.map",  # which `import robotd` loads when it is asked for
    "robotd.children.in_process",  # for tests and replays
    "robotd.front.__main__",
    "robotd.gateway.program",
    "robotd.head.__main__",  # a process of the daemon's
    *(f"robotd.cli.verbs.{module}" for module, *_ in WORDS.values()),
    "robotd.grid.kernels.build",  # these three make what is compiled and generated
    "robotd.sim.firmware.firmware_build",
    "firmware_proto.generate",
}
FOR_TESTS = {
    "conservative_poses",  # the definition that its kernel is held against, beside the proof of it
    "hit_limit",  # what befalls a head, for tests to let it
    "shut_down",
}
CALLED_BY_OTHERS = {
    *("collect", "emit", "process_renderables"),  # by libraries
    *("from_cells", "from_file", "from_store", "from_sweeps"),  # by notebooks
    "parse_known_args",  # by argparse
    "whole_parser",  # by the pages of the site
}
FILES = {
    ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): file
    for room in ("robotd", "firmware_proto")
    for file in (ROOT / room).rglob("*.py")
}


@cache
def parsed(module: str) -> ast.Module:
    """Return the tree of a module."""
    return ast.parse(FILES[module].read_text())


@cache
def imports(module: str) -> frozenset[str]:
    """Return the modules of ours that a module imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(parsed(module)):
        if isinstance(node, ast.Import):
            names |= {item.name for item in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{item.name}" for item in node.names)}
    return frozenset(names & FILES.keys())


def reached(programs: set[str]) -> set[str]:
    """Return the modules that are imported, directly or not."""
    found: set[str] = set()
    waiting = list(programs)
    while waiting:
        module = waiting.pop()
        if module not in found:
            found.add(module)
            waiting += imports(module)
    return found


def holds_code(module: str) -> bool:
    """Whether there is more in a module than a docstring."""
    return len(parsed(module).body) > 1


def test_what_no_program_reaches_is_what_stands_on_the_shelf() -> None:
    unreached = {module for module in FILES.keys() - reached(PROGRAMS) if holds_code(module)}
    assert unreached == {f"{SHELF}.{name}" for name in ON_THE_SHELF} | TWINS_ELSEWHERE


def test_the_programs_are_there_and_reach_the_house() -> None:
    assert FILES.keys() >= PROGRAMS
    assert "robotd.hardware.link.dialogue" in reached({"robotd.app.daemon"})
    assert "robotd.localization.localizer" in reached({"robotd.head.__main__"})
    assert reached({"robotd.client"}) < reached(PROGRAMS)


def test_the_engine_does_not_lean_on_the_shelf() -> None:
    assert not {module for module in reached(PROGRAMS) if module.startswith(SHELF + ".")}


def defined(module: str) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef]:
    """Yield what a module defines, at whatever depth."""
    for node in ast.walk(parsed(module)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node


def used(node: ast.AST) -> Counter[str]:
    """Return the names that are read somewhere, as a name, an attribute, a keyword, or a text that is one."""
    names: Counter[str] = Counter()
    for one in ast.walk(node):
        match one:
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.keyword(arg=str(name)):
                names[name] += 1
            case ast.Constant(value=str(text)) if text.isidentifier():
                names[text] += 1
    return names


def test_no_function_of_the_engine_is_there_for_tests_alone() -> None:
    everywhere: Counter[str] = Counter()
    for module in FILES:
        everywhere.update(used(parsed(module)))
    shelved = {f"{SHELF}.{name}" for name in ON_THE_SHELF} | TWINS_ELSEWHERE
    unused = {
        node.name
        for module in reached(PROGRAMS) - shelved - {"robotd.children.in_process"}
        for node in defined(module)
        # Less its own body: what only calls itself is called by nobody.
        if not node.name.startswith("__") and everywhere[node.name] == used(node)[node.name]
    }
    assert unused == FOR_TESTS | CALLED_BY_OTHERS
