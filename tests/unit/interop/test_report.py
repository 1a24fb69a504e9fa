"""The report of a mission: facts from events, a page that stands alone, and nothing of others that becomes markup."""

import re
import zlib
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import numpy as np

from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MapChanged, MissionPhase, MissionProgress, Status
from robotd.contract.ways import Hindrance, MissionPlan, PlannedStop, StopState
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.interop.mission_facts import MissionFacts
from robotd.interop.plain_png import grey_png
from robotd.interop.report_page import Provenance, page
from robotd.interop.report_picture import picture

S = 1_000_000_000
SPEC = GridSpec(0.5, -1.0, -2.0, (4, 6))
HOSTILE = '<script>alert("x")</script>&'
SOURCE = Provenance(HOSTILE, "0.1.0", 1_700_000_000.0, 1_700_000_000 * S, 90.0, "abc", "abc", True)


def whole_map() -> MapChanged:
    nothing = np.empty(0, np.intp)
    return MapChanged(S, "m", 0, SPEC, True, nothing, np.arange(24, dtype=np.uint8).reshape(4, 6))


def status(time_s: int, mode: str, reason: str) -> Status:
    device = DeviceStatus("drive", LinkState.READY, armed=False, faults=(HOSTILE,), counters=(("frames", 7),))
    return Status(time_s * S, mode, reason, (device,), None, (), None, None, None, None)


def pose(time_s: int, x_m: float, state: PoseState = PoseState.PREDICTED, readings: int = 0) -> PoseEstimate:
    best = None if state is PoseState.LOST else Pose2(x_m, 0.0, 0.0)
    return PoseEstimate(time_s * S, state, best, (), 0, readings, True, "m")


def step(time_s: int, number: int, phase: MissionPhase, message: str = "") -> MissionProgress:
    return MissionProgress(time_s * S, number, "map", phase, 0, 2, message)


def facts() -> MissionFacts:
    stops = (
        PlannedStop(0.0, 0.0, StopState.SWEPT),
        PlannedStop(1.5, -1.5, StopState.UNREACHED, Hindrance.TOO_NEAR, (1.0, -1.0)),
    )
    return MissionFacts.of(
        [
            status(0, "disarmed", "started"),
            status(1, "mapping", "mission 1"),
            step(1, 1, MissionPhase.STARTED),
            whole_map(),
            pose(2, 0.0),
            pose(3, 0.5),
            pose(4, 0.0, PoseState.LOST, readings=300),
            pose(5, 1.0, PoseState.LOCALIZED, readings=300),
            pose(6, 1.5),
            MissionPlan(7 * S, 1, "m", None, None, (), stops),
            step(8, 1, MissionPhase.FAILED, HOSTILE),
            status(8, "fault", HOSTILE),
            status(9, "fault", HOSTILE),
            step(10, 2, MissionPhase.STARTED),
            step(12, 2, MissionPhase.DONE, "2 stops swept"),
        ]
    )


def test_facts_are_what_was_told() -> None:
    found = facts()
    assert [(span.mission_id, span.begun_ns // S, span.last.phase) for span in found.missions.values()] == [
        (1, 1, MissionPhase.FAILED),
        (2, 10, MissionPhase.DONE),
    ]
    assert [span.mission_id for span in found.failures] == [1]
    assert found.ways_m == [[(0.0, 0.0), (0.5, 0.0)], [(1.0, 0.0), (1.5, 0.0)]]  # where it was lost the way breaks
    assert [look.state for look in found.looks] == [PoseState.LOST, PoseState.LOCALIZED]
    assert [(halt.time_ns // S, halt.mode) for halt in found.halts] == [(8, "fault")]


def test_a_picture_is_well_made_and_places_are_where_they_are() -> None:
    svg = ET.fromstring(picture(facts()))
    # All cells are known, the outermost centres 0.25 m from the border; half a metre of margin round them.
    assert svg.get("viewBox") == "-0.250 -0.500 3.500 2.750"
    lines = [line.get("points") for line in svg.iter("polyline")]
    assert lines == ["1.000,0.000 1.500,0.000", "2.000,0.000 2.500,0.000"]
    (swept,) = svg.iter("circle")
    assert (swept.get("cx"), swept.get("cy")) == ("1.000", "0.000")
    assert [title.text for title in svg.iter("title")][1:3] == ["stop 0: swept", "stop 1: unreached, too_near"]
    assert picture(MissionFacts.of([status(0, "disarmed", "started")])) == ""


class Tags(HTMLParser):
    """Which tags open and close, and all that leads elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.opened: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.opened.append(tag)
        self.links += [value or "" for name, value in attrs if name in {"href", "src", "action", "srcset"}]


def test_a_page_needs_nothing_from_elsewhere_and_runs_nothing() -> None:
    text = page(facts(), SOURCE)
    tags = Tags()
    tags.feed(text)
    assert "script" not in tags.opened
    assert all(link.startswith("data:image/png;base64,") for link in tags.links)
    assert not re.search(r"url\(|@import|https?://|\son\w+=", text)
    assert "&lt;script&gt;" in text
    assert text.encode()[:1024].count(b"<title>Mission report: ") == 1


def test_a_page_says_what_went_wrong_and_whether_it_can_be_relied_on() -> None:
    text = page(facts(), SOURCE)
    for words in (
        "22:13:28",
        "mission 1 failed",
        "too near",
        "(1.00, -1.00) m",
        "2 stops swept",
        "frames 7",
        "the same",
    ):
        assert words in text, words
    other = Provenance("a", "0.1.0", 0.0, 0, 1.0, "abc", "def", False)
    assert "otherwise: def" in page(MissionFacts(), other)
    assert "it was cut off" in page(MissionFacts(), other)


def test_a_png_is_its_pixels() -> None:
    grey = np.arange(12, dtype=np.uint8).reshape(3, 4)
    png = grey_png(grey)
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    at = png.index(b"IDAT")
    length = int.from_bytes(png[at - 4 : at], "big")
    lines = np.frombuffer(zlib.decompress(png[at + 4 : at + 4 + length]), np.uint8).reshape(3, 5)
    assert lines[:, 0].tolist() == [0, 0, 0]
    assert np.array_equal(lines[:, 1:], grey)
