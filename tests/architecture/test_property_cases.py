"""The count of property cases that a run prints is a count."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS = """
import pytest
from hypothesis import assume, given, settings, strategies as st

@settings(max_examples=30, database=None)
@given(st.integers())
def test_refuses_some(number):
    assume(number % 2 == 0)

@pytest.mark.parametrize("of_two", [1, 2])
@settings(max_examples=5, database=None)
@given(st.integers())
def test_runs_twice(of_two, number):
    pass

@settings(max_examples=100, database=None)
@given(st.integers())
def test_never_holds(number):
    assert number is None

def test_has_cases_of_its_own(record_property):
    record_property("property_cases", 7)

def test_is_no_property():
    pass
"""


def test_every_case_that_held_is_counted_and_no_other_with_workers_or_without(tmp_path: Path) -> None:
    (tmp_path / "test_properties.py").write_text(TESTS)
    alone, shared = (reported(tmp_path, *workers) for workers in ((), ("-n", "2")))
    assert "5 tests        47 cases" in alone
    assert alone == shared


def reported(folder: Path, *workers: str) -> str:
    """Run the tests of a folder; return the line of all."""
    options = ("-p", "tests.property_cases", "-p", "no:cacheprovider", "-c", "/dev/null", "--rootdir", str(folder))
    command = [sys.executable, "-m", "pytest", *options, *workers, str(folder)]
    output = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout
    return next(line for line in output.splitlines() if line.startswith("all "))
