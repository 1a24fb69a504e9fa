"""What is shipped for Prometheus and Grafana asks for metrics that there are."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.events import Status
from robotd.contract.metric_families import MetricFamily, of_metrics, of_pose, of_status
from robotd.contract.metrics import Buckets, Metrics, Sample
from robotd.contract.modes import Mode
from robotd.core.counted import Counted
from robotd.gateway.metrics.exposition_http import exposition

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples" / "prometheus"
GATEWAY = Path(__file__).parents[3] / "robotd" / "gateway" / "metrics" / "gateway_families.py"
API = Path(__file__).parents[3] / "docs" / "api.md"
DRIVE = DeviceStatus("drive", LinkState.READY, armed=True, counters=(("frames", 1), ("crc_errors", 2)))
STATUS = Status(0, Mode.IDLE, "", (DRIVE,), 24.0, (), None, None, None, None)


def there_is(name: str) -> bool:
    """Whether a metric is told of: by a status, by the gateway, or by the daemon's own list."""
    bare = re.sub(r"_(total|bucket|sum|count)$", "", name.removeprefix("robotd_"))
    of_robot = {family.name for family in (*of_status(STATUS), of_pose("lost"))}
    documented = re.findall(r"^\| `(\w+?)(?:_total)?` \|", API.read_text(), re.MULTILINE)
    return bare in of_robot or f'"{bare}"' in GATEWAY.read_text() or bare in documented


@pytest.mark.parametrize("file", sorted(EXAMPLES.iterdir()), ids=lambda file: file.name)
def test_what_is_shipped_asks_for_what_there_is(file: Path) -> None:
    text = file.read_text()
    asked = set(re.findall(r"\brobotd_\w+", text))
    assert len(asked) >= 7
    assert {name for name in asked if not there_is(name)} == set()
    assert json.loads(text) if file.suffix == ".json" else yaml.safe_load(text)


def test_counters_lose_their_ending_and_histograms_keep_their_buckets() -> None:
    buckets = Buckets("loop_lag_seconds", {}, (0.1, 1.0), (3, 4, 5), 2.5)
    told = Metrics((Sample("stops_total", {"cause": "stop"}, 2.0),), (Sample("compute_queue", {}, 1.0),), (buckets,))
    stops, queue, lag = of_metrics(told)
    assert (stops.name, stops.kind, stops.samples) == ("stops", "counter", (((("cause", "stop"),), 2.0),))
    assert (queue.name, queue.kind) == ("compute_queue", "gauge")
    assert lag == MetricFamily("loop_lag_seconds", "histogram", lag.meaning, (), (buckets,))


def test_no_line_is_mixed_with_another_kind() -> None:
    families = {family.name: family for family in of_status(STATUS)}
    assert families["line_frames"].samples == (((("line", "drive"),), 1.0),)
    assert families["line_events"].samples == (((("line", "drive"), ("event", "crc_errors")), 2.0),)


def test_promtool_finds_nothing_to_complain_of() -> None:
    promtool = shutil.which("promtool")
    if promtool is None:
        pytest.skip("promtool is not installed here: it is in Debian's package prometheus")
    counted = Counted()
    counted.count("stops_total", cause="stop")
    counted.observe("loop_lag_seconds", 0.01)
    families = [*of_status(STATUS), of_pose("lost"), *of_metrics(Metrics.of(counted))]
    text, _ = exposition(families, "")
    checked = subprocess.run([promtool, "check", "metrics"], input=text, capture_output=True, check=False)
    assert (checked.returncode, checked.stderr) == (0, b"")
    rules = subprocess.run(
        [promtool, "check", "rules", EXAMPLES / "robotd.rules.yml"], capture_output=True, check=False
    )
    assert rules.returncode == 0, rules.stdout
