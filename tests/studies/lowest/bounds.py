"""The lowest version of each dependency that ``pyproject.toml`` allows."""

import re
import tomllib

EXTRAS = ("plots", "exact", "interop", "bags", "gateway")
"""Those that a user may install; the others are for those who work on robotd."""
TOOLS = ("pytest", "pytest-timeout", "pytest-randomly", "hypothesis", "cobs", "jsonschema", "mcap-ros2-support")
"""What the tests themselves need, as new as it is."""
_BOUND = re.compile(r"([A-Za-z0-9._-]+)>=([0-9.]+)")


def lowest(pyproject: str) -> list[str]:
    """Return every dependency of robotd and of its extras as ``name==version``.

    Raises:
        ValueError: one has no lower bound.

    >>> lowest('[project]\\ndependencies = ["numpy>=1.26"]\\n[project.optional-dependencies]\\nplots = ["m>=3"]')
    ['numpy==1.26', 'm==3']
    """
    project = tomllib.loads(pyproject)["project"]
    extras = project["optional-dependencies"]
    named = [*project["dependencies"], *(one for extra in EXTRAS for one in extras.get(extra, ()))]
    pinned = []
    for one in named:
        if one.startswith("robotd["):
            continue  # another extra of ours
        found = _BOUND.fullmatch(one)
        if found is None:
            raise ValueError(f"{one!r}: expected NAME>=VERSION")
        pinned.append(f"{found[1]}=={found[2]}")
    return pinned
