"""How many cases the property tests held for: counted where they run, summed up where the report is printed.

A case counts when the test's own function returned: what Hypothesis drew and the test refused (``assume``) does not,
nor does a failure. Tests that go through seeded cases themselves say how many by
``record_property("property_cases", n)``.
"""

import functools
from collections import defaultdict
from collections.abc import Generator
from pathlib import PurePath
from typing import Any

import pytest

_KEY = "property_cases"
_held: dict[str, list[int]] = defaultdict(list)
"""Cases of each test, by its folder; workers send theirs to the process that prints."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Count the cases of a test that Hypothesis runs."""
    handle = getattr(getattr(item, "obj", None), "hypothesis", None)
    if handle is None:
        return (yield)
    test, cases = handle.inner_test, 0

    @functools.wraps(test)
    def counted(*args: Any, **kwargs: Any) -> None:
        nonlocal cases
        test(*args, **kwargs)
        cases += 1

    handle.inner_test = counted
    try:
        return (yield)
    finally:
        handle.inner_test = test
        item.user_properties.append((_KEY, cases))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Take what a test reported; with workers, in the process that gathers them."""
    cases = [value for key, value in report.user_properties if key == _KEY and isinstance(value, int)]
    if report.when == "call" and cases:
        _held[str(PurePath(report.nodeid.partition("::")[0]).parent)].append(sum(cases))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print how many cases held, folder by folder and all together."""
    if not _held:
        return
    terminalreporter.section("property tests")
    every = [cases for folder in _held.values() for cases in folder]
    for name, counts in (*sorted(_held.items()), ("all", every)):
        terminalreporter.write_line(f"{name:<38}{len(counts):>6} tests {sum(counts):>9} cases")
