"""Under which licence a package is, as its metadata say, and whether robotd may be installed with it."""

import re
from collections.abc import Mapping, Sequence

ALLOWED = frozenset(
    {
        "0BSD",
        "Apache-2.0",
        "BSD",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "HPND",
        "ISC",
        "MIT",
        "MIT-0",
        "MIT-CMU",
        "MPL-2.0",
        "PSF-2.0",
        "Python-2.0",
        "Zlib",
        "CC0-1.0",
        "any-OSI",  # whichever one likes, of those that the OSI has approved
    }
)
"""Those that ask for no more than to be named, or, as the MPL, for changes to the package itself."""
NOTED: Mapping[str, str] = {
    "gmpy2": "LGPL-3.0-or-later: of the extra exact alone, linked by nothing of ours",
}
"""Packages under others, and why they are let pass."""
_NAMES = {
    "apache software license": "Apache-2.0",
    "apache 2.0": "Apache-2.0",
    "apache license 2.0": "Apache-2.0",
    "apache license, version 2.0": "Apache-2.0",
    "apache": "Apache-2.0",
    "bsd license": "BSD",
    "bsd": "BSD",
    "3-clause bsd license": "BSD-3-Clause",
    "new bsd": "BSD-3-Clause",
    "isc license (iscl)": "ISC",
    "mit license": "MIT",
    "mozilla public license 2.0 (mpl 2.0)": "MPL-2.0",
    "python software foundation license": "PSF-2.0",
    "psf": "PSF-2.0",
    "zlib/libpng license": "Zlib",
    "historical permission notice and disclaimer (hpnd)": "HPND",
    "cmu license (mit-cmu)": "MIT-CMU",
}
"""How those that came before SPDX are called in classifiers and free text."""
_CLASSIFIER = "License :: OSI Approved :: "


def licence_of(expression: str | None, classifiers: Sequence[str], text: str | None) -> str:
    """Return the licence as SPDX has it where that is known, from the best of what is told; empty if nothing is.

    Args:
        expression: the field ``License-Expression``.
        classifiers: all of them.
        text: the field ``License``: a name, or the whole of it.

    >>> licence_of(None, ["License :: OSI Approved :: MIT License"], None)
    'MIT'
    """
    if expression:
        return expression
    said = [one.removeprefix(_CLASSIFIER) for one in classifiers if one.startswith(_CLASSIFIER)]
    if not said and text:
        said = [text.strip().splitlines()[0]]
    return " AND ".join(_NAMES.get(one.lower(), one) for one in said)


def is_allowed(licence: str) -> bool:
    """Return whether it is: of alternatives one must be, of what holds together all; nothing told is not.

    >>> is_allowed("MIT OR GPL-3.0-only"), is_allowed("MIT AND GPL-3.0-only"), is_allowed("")
    (True, False, False)
    """
    return any(
        all(one.strip(" ()") in ALLOWED for one in re.split(r"\s+AND\s+", either))
        for either in re.split(r"\s+OR\s+", licence)
    )
