"""Plans of faults: what can be written, what is refused and why, and that it happens when it should."""

import asyncio
import contextlib
from pathlib import Path

import pytest

from robotd.core.errors import ConfigError, TransportError
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.serial_port import open_serial
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.cable import Cable
from robotd.sim.faults.fault import Fault
from robotd.sim.faults.laid import cables, run_faulty_on_ptys
from robotd.sim.faults.of_bytes import Garbage
from robotd.sim.faults.plan import PlannedFault, carry_out, parse_plan
from robotd.sim.robot import DEVICES, SimulatedRobot

LINE = LineFormat(115_200)


def ignore(_: str) -> None:
    """Anyone who looks at the links need not be told."""


def robot(dialects: Dialects | None = None) -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), 1, dialects=dialects)


async def is_refused(cable: Cable) -> bool:
    try:
        (await cable.connect()).close()
    except TransportError:
        return True
    return False


def test_a_plan_is_read_in_the_order_in_which_things_happen() -> None:
    assert parse_plan("rangefinder:garbage@35s+2s, drive:unplug@20.5s") == (
        PlannedFault("drive", "unplug", 20.5),
        PlannedFault("rangefinder", "garbage", 35.0, 2.0),
    )


def test_all_means_each_device() -> None:
    assert [fault.device for fault in parse_plan("all:silence@1s+1s")] == sorted(DEVICES)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "expected DEVICE:FAULT@START"),
        ("drive:unplug", "expected DEVICE:FAULT@START"),
        ("drive:unplug@20", "expected DEVICE:FAULT@START"),
        ("drive:unplug@-1s", "expected DEVICE:FAULT@START"),
        ("wheel:unplug@2s", "no such device: 'wheel'; known: drive, pantilt, rangefinder, all"),
        ("drive:explode@2s", "no such fault: 'explode'; known: unplug"),
        ("drive:garbage@2s,drive:unplug@5s", "drive:unplug@5s begins before garbage is over"),
        ("all:garbage@2s+4s,pantilt:unplug@5s", "pantilt:unplug@5s begins before garbage is over"),
    ],
)
def test_what_is_no_plan_is_refused_with_the_reason(text: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_plan(text)
    assert complaint in str(caught.value)


async def test_faults_begin_and_end_in_their_time() -> None:
    async with cables(robot()) as laid:
        said: list[str] = []
        plan = parse_plan("drive:garbage@2s+3s,drive:unplug@5s+1s")
        task = asyncio.create_task(carry_out(plan, laid, seed=1, say=said.append))
        await asyncio.sleep(1.9)
        assert laid["drive"].fault.__class__ is Fault
        await asyncio.sleep(0.2)
        assert laid["drive"].fault.__class__ is Garbage
        await asyncio.sleep(3.0)
        assert await is_refused(laid["drive"])
        await asyncio.sleep(1.0)
        assert not await is_refused(laid["drive"])
        await task
        assert [text for text in said if "garbage" in text] == ["drive: garbage begins", "drive: garbage is over"]
        assert [text for text in said if "unplug" in text] == ["drive: unplug begins", "drive: unplug is over"]


async def test_a_reboot_that_a_vendor_device_cannot_do_is_refused_before_anything_happens() -> None:
    async with cables(robot(Dialects(drive="rflex"))) as laid:
        with pytest.raises(ConfigError, match="drive: only our own boards can be rebooted"):
            await carry_out(parse_plan("pantilt:unplug@0s,drive:reboot@3s"), laid, seed=1, say=ignore)
        assert laid["pantilt"].is_plugged


@pytest.mark.real_clock
async def test_on_pseudo_terminals_the_link_goes_and_comes_back_to_another_name(tmp_path: Path) -> None:
    (tmp_path / "notes").write_text("not ours")
    link, announced = tmp_path / "drive", asyncio.Event()
    task = asyncio.create_task(
        run_faulty_on_ptys(
            robot(),
            parse_plan("drive:unplug@0.3s+0.2s,pantilt:eio@0.1s+0.2s"),
            seed=1,
            say=ignore,
            announce=lambda _: announced.set(),
            directory=tmp_path,
        )
    )
    await announced.wait()
    head = await open_serial(str(tmp_path / "pantilt"), LINE)
    line, before = await open_serial(str(link), LINE), link.resolve()
    await asyncio.sleep(0.2)
    head.write(b"anybody?")
    with pytest.raises(TransportError):
        await head.read()
    with pytest.raises(TransportError):
        await line.read()
    with pytest.raises(TransportError, match="no such device"):
        await open_serial(str(link), LINE)
    await asyncio.sleep(0.5)
    assert link.resolve() != before
    line.close()
    (await open_serial(str(link), LINE)).close()
    (await open_serial(str(tmp_path / "pantilt"), LINE)).close()
    task.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await task
    assert not link.is_symlink()
    assert (tmp_path / "notes").exists()
