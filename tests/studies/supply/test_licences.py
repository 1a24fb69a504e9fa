"""Licences are told by the best of what metadata say, and only those that are allowed pass."""

import pytest

from tests.studies.supply.licences import is_allowed, licence_of


@pytest.mark.parametrize(
    ("expression", "classifiers", "text", "licence"),
    [
        ("BSD-3-Clause AND MIT", ["License :: OSI Approved :: MIT License"], "all of it", "BSD-3-Clause AND MIT"),
        (None, ["Topic :: Software", "License :: OSI Approved :: BSD License"], "MIT", "BSD"),
        (None, [], "Apache License 2.0\n\nTERMS", "Apache-2.0"),
        (None, [], None, ""),
    ],
)
def test_what_is_told_best_counts(
    expression: str | None, classifiers: list[str], text: str | None, licence: str
) -> None:
    assert licence_of(expression, classifiers, text) == licence


@pytest.mark.parametrize("licence", ["MIT", "Apache-2.0 OR GPL-2.0-only", "(MIT AND PSF-2.0)"])
def test_these_pass(licence: str) -> None:
    assert is_allowed(licence)


@pytest.mark.parametrize("licence", ["", "GPL-3.0-only", "MIT AND AGPL-3.0-only", "GNU General Public License (GPL)"])
def test_these_do_not(licence: str) -> None:
    assert not is_allowed(licence)
