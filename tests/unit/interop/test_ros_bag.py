"""Bags that others wrote, as logs: each scan where it was taken, whatever the frames say of robot and scanner."""

import math
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.core.errors import RecordingError, RobotdError
from robotd.core.pose import Pose2
from robotd.interop.ros_bag import read_bag
from robotd.logs.scan import PoseSource
from robotd.sim.buildings.log_file import read_log
from tests.support.bags import Recorded, write_room_bag
from tests.support.carmen_room import POSES, assert_the_room_is_seen

DRIFT = Pose2(0.4, -0.3, 0.2)


@pytest.mark.parametrize("name", ["a.bag", "a", "a3"])
@pytest.mark.parametrize(
    "recorded",
    [
        Recorded(),
        Recorded(mount=Pose2(-0.3, 0.1, math.pi - 0.1)),
        Recorded(mount=Pose2(0.1, 0.05, -0.4), upside_down=True),
        Recorded(clockwise=True),
        Recorded(has_odometry=False),
        Recorded(drift=DRIFT, has_map=True),
        Recorded(drift=DRIFT, has_map=True, has_odometry=False, slash="/"),
    ],
    ids=["plain", "looks back", "upside down", "clockwise", "frames alone", "localized", "slashes"],
)
def test_every_scan_lies_on_the_walls(name: str, recorded: Recorded, tmp_path: Path) -> None:
    log = read_log(write_room_bag(tmp_path / name, recorded))
    assert_the_room_is_seen(log)
    for scan, pose in zip(log.scans, POSES, strict=True):
        assert scan.robot_pose.distance_m(pose) < 1e-6
    assert log.poses is (PoseSource.CORRECTED if recorded.has_map else PoseSource.RAW_ODOMETRY)
    if recorded.has_map:  # what was driven by odometry is kept beside
        assert log.scans[-1].odometry.distance_m(DRIFT.inverse() @ POSES[-1]) < 1e-6


def test_a_bag_of_one_file_is_read_without_its_directory(tmp_path: Path) -> None:
    write_room_bag(tmp_path / "a")
    write_room_bag(tmp_path / "b3")
    assert_the_room_is_seen(read_log(tmp_path / "a" / "a.mcap"))
    assert_the_room_is_seen(read_log(tmp_path / "b3" / "b3.db3"))


def test_ranges_mean_what_rep_117_says(tmp_path: Path) -> None:
    def spoil(ranges: np.ndarray[Any, Any]) -> None:
        ranges[10:16] = [math.inf, 31.0, math.nan, -math.inf, 0.01, 0.0]

    for scan in read_bag(write_room_bag(tmp_path / "a.bag", Recorded(spoil=spoil))).scans:
        assert scan.missed[8:18].tolist() == [False, False, True, True, *[False] * 6]
        assert scan.hit[8:18].tolist() == [True, True, *[False] * 6, True, True]


def test_what_a_bag_does_not_say_is_said(tmp_path: Path) -> None:
    log = read_bag(write_room_bag(tmp_path / "a.bag", Recorded(mount=None)))
    assert_the_room_is_seen(log)
    assert "no frame says where laser sits on the robot" in " ".join(log.remarks())


def test_of_several_scanners_one_is_taken_and_told(tmp_path: Path) -> None:
    bag = write_room_bag(tmp_path / "a.bag", Recorded(scan_topics=("/back/scan", "/front/scan")))
    assert "--scan-topic takes /front/scan" in " ".join(read_bag(bag).remarks())
    assert_the_room_is_seen(read_bag(bag, "/front/scan"))
    with pytest.raises(RecordingError, match="no LaserScan on /scan; there is on /back/scan, /front/scan"):
        read_bag(bag, "/scan")


def test_scans_at_whose_time_the_robot_is_nowhere_are_left_out_and_counted(tmp_path: Path) -> None:
    # A pose every 2.5 s, and a robot that moves: where it was between them is not known.
    log = read_bag(write_room_bag(tmp_path / "a.bag", Recorded(pose_every=5)))
    assert [scan.robot_pose.distance_m(pose) < 1e-6 for scan, pose in zip(log.scans, POSES[::5], strict=True)]
    assert "9 scans were left out: it is not known where the robot was" in " ".join(log.remarks())
    with pytest.raises(
        RecordingError, match=r"b\.bag: nothing says where the robot was: there is no nav_msgs/Odometry"
    ):
        read_bag(write_room_bag(tmp_path / "b.bag", Recorded(pose_every=99, has_odometry=False)))


def test_without_the_extra_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bag = write_room_bag(tmp_path / "a.bag")
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(RobotdError, match=r"install the extra bags, pip install 'robotd\[bags\]'"):
        read_log(bag)


@pytest.mark.parametrize("name", ["a.bag", "a3", "a"])
def test_damage_anywhere_ends_in_a_refusal_or_in_fewer_scans(name: str, tmp_path: Path) -> None:
    bag = write_room_bag(tmp_path / name)
    file = bag if bag.is_file() else next(path for path in bag.iterdir() if path.suffix in {".mcap", ".db3"})
    whole, generator = file.read_bytes(), np.random.default_rng(3)
    read = 0
    for _ in range(10):
        at = int(generator.integers(len(whole)))
        damaged = bytearray(whole)
        damaged[at] ^= int(generator.integers(1, 256))
        file.write_bytes(whole[:at] if generator.random() < 0.3 else bytes(damaged))
        with suppress(RecordingError):  # and no other error
            read += len(read_bag(bag).scans) > 0
    assert read > 0, "a flipped bit in a range does no harm"


def test_a_directory_that_only_says_to_be_a_bag_is_refused(tmp_path: Path) -> None:
    bag = write_room_bag(tmp_path / "a")
    (bag / "metadata.yaml").write_text("- not\n- this\n")
    with pytest.raises(RecordingError, match="not a bag that can be read"):
        read_log(bag)
    shutil.rmtree(bag)
    bag.mkdir()
    with pytest.raises(RecordingError, match="Is a directory"):
        read_log(bag)
