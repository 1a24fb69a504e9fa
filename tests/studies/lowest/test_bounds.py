"""Each dependency says which version of it is the lowest that will do."""

from pathlib import Path

import pytest

from tests.studies.lowest.bounds import lowest


def test_each_dependency_has_a_lower_bound() -> None:
    assert "numpy==1.26" in lowest(Path("pyproject.toml").read_text())


def test_one_without_is_named() -> None:
    with pytest.raises(ValueError, match="'rich': expected NAME>=VERSION"):
        lowest('[project]\ndependencies = ["rich"]\n[project.optional-dependencies]')
