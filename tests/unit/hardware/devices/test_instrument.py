"""A distance that cannot be is a failed reading, whatever dialect it came in: never free space up to the cut-off."""

import asyncio
import csv
import os
import random
from pathlib import Path

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.contract.device_status import LinkState
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.hardware.devices.calibration import HeadMount, RangefinderCalibration
from robotd.hardware.devices.catalogue import rangefinder
from robotd.hardware.devices.dialect_options import TfminiSettings
from robotd.hardware.devices.dialects import RANGEFINDERS
from robotd.hardware.devices.instrument import Instrument
from robotd.hardware.devices.pantilt import AimReadback
from robotd.hardware.devices.rangefinder import Rangefinder, Shot
from robotd.hardware.devices.reading_in_robot import reading_in_robot
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Transport
from robotd.hardware.wire import tfmini
from robotd.hardware.wire.tfmini import Model
from robotd.sim.physics.plant import ShotAnswer
from tests.support.taps import NoTap
from tests.unit.hardware.devices.conftest import nowhere, rig
from tests.unit.hardware.devices.sensing import sensor

REACH_M = {
    "board": 500.0,
    "dimetix": 500.0,
    "disto": 200.0,
    "lw20": 100.0,
    "lwnx": 100.0,
    "scip": 120.0,
    "tfmini": 15.0,
    "tfmini-s": 15.0,
    "tfmini-plus": 15.0,
    "tf-luna": 10.0,
}


def laid(shot: Shot, calibration: RangefinderCalibration | None = None) -> RangeReading:
    """Lay a shot straight ahead of a robot whose cut-off is 6 m."""
    return reading_in_robot(HeadMount(), calibration or RangefinderCalibration(), AimReadback(0, 0.0, 0.0), shot)


def instrument(dialect: str) -> Instrument:
    """Return the instrument in the adapter of a dialect."""
    device = rangefinder(RANGEFINDERS[dialect].options(dialect=dialect), Wiring(nowhere, NoTap(), random.Random(0)))
    found = vars(device)["_instrument"]
    assert isinstance(found, Instrument)
    return found


def test_every_dialect_has_a_reach() -> None:
    assert set(REACH_M) == set(RANGEFINDERS)


@pytest.mark.parametrize("dialect", REACH_M)
def test_the_reach_is_the_last_distance_that_is_believed(dialect: str) -> None:
    it = instrument(dialect)
    assert it.shot(0, REACH_M[dialect], 1).status is ReadingStatus.OK
    assert it.shot(0, 0.0, 1).status is ReadingStatus.OK
    assert it.implausible == 0
    for distance_m in (REACH_M[dialect] + 0.01, -0.0001, 1e9, float("inf"), float("nan")):
        shot = it.shot(0, distance_m, 1)
        assert (shot.status, shot.range_m) == (ReadingStatus.DEVICE_ERROR, None)
        assert laid(shot).range_m is None
    assert it.implausible == 5


def test_only_a_credible_far_reading_is_a_miss() -> None:
    it = instrument("tf-luna")
    assert laid(it.shot(0, 9.0, 500)).status is ReadingStatus.MISS
    assert laid(it.shot(0, 228.73, 500)).status is ReadingStatus.DEVICE_ERROR


def test_a_miss_reaches_no_farther_than_the_instrument() -> None:
    far = RangefinderCalibration(range_max_m=20.0)
    shot = instrument("tfmini").nothing_within(0, 12.0, 500)
    assert (laid(shot, far).status, laid(shot, far).range_m) == (ReadingStatus.MISS, 12.0)
    assert laid(shot).range_m == 6.0
    assert laid(Shot(0, ReadingStatus.MISS, None, None), far).range_m == 20.0


class Wired:
    """A TFmini of some model that answers each trigger with one frame."""

    def __init__(self, device: Rangefinder) -> None:
        self.device = device
        self.data = b""

    async def answer(self, line: Transport) -> None:
        typed = b""
        while True:
            typed += await line.read()
            if tfmini.VERSION in typed:
                line.write(tfmini.command(0x01, b"\x08\x00\x02"))
            if tfmini.TRIGGER in typed:
                line.write(self.data)
            if typed.endswith((tfmini.VERSION, tfmini.TRIGGER)):
                typed = b""


def frame(distance: int, strength: int) -> bytes:
    head = b"\x59\x59" + distance.to_bytes(2, "little") + strength.to_bytes(2, "little") + b"\xc8\x08"
    return head + bytes((sum(head) & 0xFF,))


@pytest.mark.parametrize(
    ("model", "distance_cm", "status"),
    [
        *((Model.TFMINI, distance, ReadingStatus.DEVICE_ERROR) for distance in (65532, 65533, 30_000, 1501)),
        (Model.TFMINI, 65535, ReadingStatus.WEAK),
        (Model.TFMINI, 65534, ReadingStatus.SATURATED),
        (Model.TFMINI, 1200, ReadingStatus.MISS),
        (Model.TFMINI_S, 65532, ReadingStatus.AMBIENT),
        (Model.TFMINI_S, 65533, ReadingStatus.DEVICE_ERROR),
        *((model, 65532, ReadingStatus.DEVICE_ERROR) for model in (Model.TFMINI_PLUS, Model.TF_LUNA)),
        (Model.TFMINI_PLUS, 65533, ReadingStatus.DEVICE_ERROR),
        (Model.TF_LUNA, 22_873, ReadingStatus.DEVICE_ERROR),
        (Model.TF_LUNA, 887, ReadingStatus.OK),
        (Model.TF_LUNA, 0, ReadingStatus.WEAK),
    ],
)
async def test_what_a_tfmini_cannot_have_measured_is_a_fault(
    model: Model, distance_cm: int, status: ReadingStatus
) -> None:
    near, far = memory_pair()

    async def connect() -> Transport:
        return near

    settings = TfminiSettings(dialect=model.value)
    it = Wired(rangefinder(settings, Wiring(connect, NoTap(), random.Random(0))))
    it.data = frame(distance_cm, 900)
    tasks = [asyncio.create_task(it.answer(far)), asyncio.create_task(it.device.run())]
    with it.device.status_changes.subscribe() as changes:
        while it.device.status.link is not LinkState.READY:
            await changes.get()
    shot = await it.device.shoot(timeout_s=1.0)
    assert shot.status is status
    assert laid(shot).is_measured == (status in {ReadingStatus.OK, ReadingStatus.MISS})
    assert dict(it.device.status.counters)["implausible"] == (status is ReadingStatus.DEVICE_ERROR)
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)


@pytest.mark.parametrize(
    ("dialect", "distance_m"),
    [("dimetix", 9999.9999), ("dimetix", 501.0), ("disto", 201.0), ("lw20", 100.01), ("lwnx", 101.0), ("lw20", 327.0)],
)
async def test_beyond_the_reach_of_its_model_is_a_device_error(dialect: str, distance_m: float) -> None:
    async with sensor(dialect) as s:
        s.wall.answer = ShotAnswer(ShotStatus.OK, distance_m, 60_000, 4_000)
        await s.device.switch_laser(on=True)
        shot = await s.device.shoot(timeout_s=1.0)
        assert (shot.status, shot.range_m) == (ReadingStatus.DEVICE_ERROR, None)
        assert dict(s.device.status.counters)["implausible"] == 1


async def test_our_own_board_is_believed_as_far_as_any_instrument_reaches() -> None:
    async with rig() as r:
        await r.rangefinder.switch_laser(on=True)
        for distance_m, status in ((499.0, ReadingStatus.OK), (4_294_967.295, ReadingStatus.DEVICE_ERROR)):
            r.robot._laser.shoot = lambda at_us, far_m=distance_m: ShotAnswer(ShotStatus.OK, far_m, 9, 1000)  # type: ignore[method-assign,misc]  # a wall so far away
            assert (await r.rangefinder.shoot(timeout_s=1.0)).status is status


@pytest.mark.real_data
def test_the_seven_impossible_ranges_of_real_sweeps_are_no_free_space() -> None:
    root = os.environ.get("ROBOTD_DATA")
    if root is None:
        pytest.skip("ROBOTD_DATA is not set")
    file = Path(root) / "pibot-tfluna-stops" / "stops.csv"
    with file.open() as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    it = instrument("tf-luna")
    readings = [laid(it.shot(0, int(row["range_cm"]) / 100, 500)) for row in rows]
    assert sum(reading.status is ReadingStatus.DEVICE_ERROR for reading in readings) == 7
    assert it.implausible == 7
