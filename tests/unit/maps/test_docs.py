"""docs/maps.md says of a stored map what is so, and its program reads one."""

import json
import re
import subprocess
import sys
from pathlib import Path

from robotd.maps.manifest import SCHEMA
from robotd.maps.stop_columns import StopColumns
from robotd.maps.stops_file import READINGS_MAX, decode_stops
from robotd.maps.version_files import CELLS, IMAGE, MANIFEST, STOPS, YAML

HERE = Path(__file__).parent
TEXT = (HERE.parents[2] / "docs" / "maps.md").read_text()
VERSION = HERE / f"schema_{SCHEMA}" / "office" / "1"


def named_first(text: str) -> set[str]:
    """Return what the first cells of the tables in a text name."""
    rows = [line.split(" | ")[0] for line in text.splitlines() if line.startswith("| `")]
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


def test_every_file_key_and_column_stands_there_and_no_other() -> None:
    manifest, stops = TEXT.split("## The manifest")[1].split("## The stops")
    assert named_first(manifest) == set(json.loads((VERSION / MANIFEST).read_bytes()))
    assert named_first(stops) | {"statuses"} == set(StopColumns.__struct_fields__)
    assert {path.name for path in VERSION.iterdir()} == {MANIFEST, CELLS, STOPS, IMAGE, YAML}
    assert all(f" {path.name} " in TEXT for path in VERSION.iterdir())
    assert f"| `schema` | {SCHEMA}. " in TEXT
    assert f"at most {READINGS_MAX} readings" in TEXT


def test_its_program_reads_stops(tmp_path: Path) -> None:
    program = tmp_path / "read_stops.py"
    (found,) = re.findall(r"(?s)```python\n(.*?)```", TEXT)
    program.write_text(found)
    said = subprocess.run(
        [sys.executable, str(program), str(VERSION / STOPS)], capture_output=True, text=True, check=True
    ).stdout
    stops = decode_stops((VERSION / STOPS).read_bytes()).stops
    assert said.splitlines() == [
        f"{[pose.x_m, pose.y_m, pose.heading_rad]} {len(stop.readings)} {stop.readings['range_m'].max()}"
        for stop in stops
        for pose in [stop.map_from_robot]
    ]
