"""The figures of ``make lag`` are of the time that is asked for, and none is invented."""

from array import array
from pathlib import Path

import pytest

from tests.studies.lag.run import NOW, write_page
from tests.studies.lag.samples import Samples


def test_figures_are_of_what_began_in_between(tmp_path: Path) -> None:
    beats = array("q", [0, 9_000_000, 10, 1_000_000, 11, 3_000_000, 12, 2_000_000, 20, 9_000_000])
    Samples.of(array("q", [5, 9_000_000, 15, 4_000_000]), beats).write(tmp_path / "of.npz")
    figures = Samples.read(tmp_path / "of.npz").between(10, 20)
    assert (figures.lag_p50_ms, figures.lag_p999_ms, figures.lag_max_ms) == (2.0, 3.0, 3.0)
    assert (figures.callback_p999_ms, figures.callback_max_ms) == (4.0, 4.0)
    assert figures.row("a", "b").startswith("| a | b | 2.00 | 3.00 | 3.00 | 4.00 | 4.00 |")


def test_nothing_measured_is_said() -> None:
    with pytest.raises(IndexError):
        Samples.of(array("q"), array("q")).between(0, 1)


def test_what_was_measured_before_stays_on_the_page(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{NOW}old\n")
    write_page(page, "new")
    assert page.read_text() == f"before\n{NOW}\nnew\n"
