"""Files that are made of recordings: by robotctl, one at a time, kept for a while, and refused in its words."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotd.core.errors import ServerError
from robotd.gateway import made_files
from robotd.gateway.made_files import FORMS, MadeFiles

REPORT, FOXGLOVE, BAG = FORMS


class Robotctl:
    """Writes what it was asked for, when it may."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, ...]] = []
        self.may = asyncio.Event()
        self.may.set()

    async def __call__(self, *arguments: str) -> None:
        self.asked.append(arguments[:-2])
        await self.may.wait()
        _write(Path(arguments[-1]), arguments[-2])


def _write(out: Path, of: str) -> None:
    if out.suffix:
        out.write_text(f"made of {of}")
    else:
        out.mkdir()
        (out / "metadata.yaml").write_text("of a bag")


@pytest.fixture(name="recording")
def _recording(tmp_path: Path) -> Path:
    (tmp_path / "a.mcap").write_bytes(b"recorded")
    return tmp_path / "a.mcap"


@pytest.fixture(name="made")
def _made() -> Iterator[MadeFiles]:
    made = MadeFiles()
    yield made
    made.forget()


async def test_each_form_is_made_once_and_kept_for_a_while(
    recording: Path, made: MadeFiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    robotctl = Robotctl()
    monkeypatch.setattr(made_files, "_robotctl", robotctl)
    first = await made.of(recording, REPORT)
    assert first.read_text() == f"made of {recording}"
    assert await made.of(recording, REPORT) == first
    bag = await made.of(recording, BAG)
    assert (bag.suffix, [path.name for path in bag.parent.iterdir()]) == (".zip", ["a.zip"])
    assert robotctl.asked == [("report",), ("export", "bag")]
    others = []
    for number in range(4):
        others.append(recording.with_name(f"{number}.mcap"))
        others[-1].write_bytes(b"")
        await made.of(others[-1], FOXGLOVE)
    assert not first.exists()
    assert not bag.exists()
    folder = first.parent.parent
    made.forget()
    assert not folder.exists()


async def test_a_second_one_has_to_wait_and_what_was_given_up_leaves_nothing(
    recording: Path, made: MadeFiles, monkeypatch: pytest.MonkeyPatch
) -> None:
    robotctl = Robotctl()
    monkeypatch.setattr(made_files, "_robotctl", robotctl)
    robotctl.may.clear()
    first = asyncio.create_task(made.of(recording, REPORT))
    await asyncio.sleep(0.01)
    with pytest.raises(ServerError, match="busy"):
        await made.of(recording, FOXGLOVE)
    first.cancel()
    await asyncio.wait((first,))
    robotctl.may.set()
    assert (await made.of(recording, REPORT)).exists()


@pytest.mark.real_clock
async def test_what_is_no_recording_is_refused_in_robotctls_words(recording: Path, made: MadeFiles) -> None:
    with pytest.raises(ServerError, match=r"a\.mcap") as refused:
        await made.of(recording, REPORT)
    assert refused.value.code == "refused"
