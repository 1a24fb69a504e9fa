"""How the pages become a site: ``make docs``. They stay where they are, so that links between them work everywhere."""

import sys
from pathlib import Path

import robotd

sys.path.insert(0, str(Path(__file__).parent))  # for the directive

project = "robotd"
version = release = robotd.__version__
copyright = "the authors of robotd"  # noqa: A001  # as Sphinx calls it
extensions = ["myst_parser", "commands"]
root_doc = "docs/index"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "docs/*.md",
    "docs/**/*.md",
    "docs/**/*.png",
    "firmware_proto/PROTOCOL.md",
    "tests/README.md",
]
# Messages of the protocol are one level below what a page would have: they are looked up, not read one after the other.
suppress_warnings = ["myst.header"]
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
html_theme = "furo"
html_title = "robotd"
html_theme_options = {"navigation_with_keys": True}
html_show_sphinx = False
# Nothing of a page comes from elsewhere: a robot's network may have no way out.
html_use_opensearch = ""
