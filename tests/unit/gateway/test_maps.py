"""Maps leave a gateway as other programs' files, and come as such; what is no map is said in words."""

import asyncio
import io
import zipfile
from typing import Any

import aiohttp
import numpy as np
import pytest
import yaml
from PIL import Image
from yarl import URL

from robotd.core.errors import MissionError
from robotd.gateway.http import map_exchange
from robotd.interop.map_bundle import map_of_files
from tests.unit.gateway.rig import Opening
from tests.unit.server.conftest import stored_map

pytestmark = pytest.mark.real_clock
YAML = b"""image: lab.pgm
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
occupied_thresh: 0.65
free_thresh: 0.196
negate: 0
"""
PGM = b"P5 4 3 255\n" + bytes([254, 254, 205, 0, 254, 254, 254, 0, 0, 0, 0, 0])


def zipped(**files: bytes) -> bytes:
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name.replace("_", "."), data)
    return written.getvalue()


async def sent(session: aiohttp.ClientSession, query: str, *files: tuple[str, bytes]) -> tuple[int, dict[str, Any]]:
    form = aiohttp.FormData()
    for name, data in files:
        form.add_field("file", io.BytesIO(data), filename=name)
    async with session.post(f"api/maps{query}", data=form if files else b"") as answer:
        told: dict[str, Any] = await answer.json()
        return answer.status, told


async def test_a_stored_map_is_a_picture(opening: Opening) -> None:
    async with opening() as rig, rig.browser("viewer") as session:
        async with session.get("api/maps/office/3.png") as answer:
            assert (answer.status, (await answer.read())[:8]) == (200, b"\x89PNG\r\n\x1a\n")
        for name in ("office/x.png", "..%2F..%2Fa/1.png", "none/1.png", "office/99999999999.png"):
            async with session.get(URL(f"{rig.address}api/maps/{name}", encoded=True)) as answer:
                assert answer.status == 404, name


async def test_a_page_of_cards_has_all_its_pictures_though_the_daemon_shows_two_maps_at_a_time(
    opening: Opening,
) -> None:
    async def picture(session: aiohttp.ClientSession, version: int) -> int:
        async with session.get(f"api/maps/office/{version}.png?small") as answer:
            return answer.status

    async with opening() as rig, rig.browser("viewer") as session:
        assert await asyncio.gather(*(picture(session, version) for version in range(1, 9))) == [200] * 8


async def test_a_stored_map_leaves_as_files_and_comes_back_as_it_was(opening: Opening) -> None:
    async with opening() as rig, rig.browser("viewer") as session:
        found = {}
        for kind in ("pgm", "yaml", "zip"):
            async with session.get(f"api/maps/office/3.{kind}") as answer:
                assert answer.headers["Content-Disposition"] == f'attachment; filename="office-3.{kind}"'
                found[kind] = await answer.read()
    stored = stored_map("office", 3)
    back = map_of_files({"office-3.zip": found["zip"]}).grid
    assert (back.spec, back.cells.tolist()) == (stored.spec, stored.values.tolist())
    assert yaml.safe_load(found["yaml"])["image"] == "office-3.pgm"
    assert Image.open(io.BytesIO(found["pgm"])).size == stored.spec.shape[::-1]


async def test_a_map_is_looked_at_and_stored_by_who_may(opening: Opening) -> None:
    files = (("lab.yaml", YAML), ("lab.pgm", PGM))
    counted = {"rows": 3, "cols": 4, "resolution_m": 0.05, "free_cells": 5, "unknown_cells": 1, "occupied_cells": 6}
    walls = "50% of it are walls: was what nobody has seen drawn in black? It then stops beams"
    async with opening() as rig:
        async with rig.browser("viewer") as session:
            assert (await sent(session, "?name=lab", *files))[0] == 403
        async with rig.browser() as session:
            assert await sent(session, "", *files) == (200, {**counted, "notes": [walls]})
            assert rig.control.calls == []
            status, told = await sent(session, "?name=lab", *files)
            assert (status, told["map"]["name"], told["map"]["version"]) == (200, "lab", 1)
            assert rig.control.calls == ["import lab of lab.yaml, lab.pgm 3 x 4"]
            assert rig.control.clients[-1] == "some operator, in the console"
            assert [one.what for one in rig.house.services.audit.all] == ["sign in", "sign in", "map_import lab"]
            assert (await sent(session, "?resolution_m=0.1", ("lab.pgm", PGM)))[1]["resolution_m"] == 0.1
            assert (await sent(session, "", ("lab.zip", zipped(lab_yaml=YAML, lab_pgm=PGM))))[1]["free_cells"] == 5


@pytest.mark.parametrize(
    ("query", "files", "code", "why"),
    [
        ("", (), "malformed", "multipart"),
        ("?name=..%2Fevil", (("lab.pgm", PGM),), "bad_argument", "name"),
        ("?resolution_m=nan", (("lab.pgm", PGM),), "bad_argument", "resolution"),
        ("", (("lab.pgm", PGM),), "bad_argument", "says nothing of its size"),
        ("", (("lab.yaml", YAML),), "bad_argument", "speaks of the picture lab.pgm, which is not there"),
        ("", (("lab.yaml", YAML), ("lab.pgm", PGM[:-4])), "bad_argument", "damaged"),
        ("", (("lab.yaml", b"\xff{"), ("lab.pgm", PGM)), "bad_argument", "it is no yaml"),
        ("", (("passwd", b"root"),), "bad_argument", "expected a yaml and its picture"),
        ("", (("a.pgm", PGM), ("b.pgm", PGM), ("c.yaml", YAML)), "malformed", "at most 2"),
        ("", (("lab.zip", b"PK\x03\x04 and no more"),), "bad_argument", "lab.zip is damaged"),
        ("", (("lab.zip", zipped(a_yaml=YAML, b_yaml=YAML, c_yaml=YAML)),), "bad_argument", "more than a yaml"),
        # It says a thousandth of what it grows to.
        ("", (("lab.zip", zipped(lab_yaml=bytes(1 << 24))),), "bad_argument", "larger than that of any map"),
    ],
)
async def test_what_is_no_map_is_said_in_words(
    opening: Opening, query: str, files: tuple[tuple[str, bytes], ...], code: str, why: str
) -> None:
    async with opening() as rig, rig.browser() as session:
        _, told = await sent(session, query, *files)
        assert told["code"] == code
        assert why in told["message"]
        assert rig.control.calls == []


async def test_files_that_are_too_large_are_not_even_read(opening: Opening, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(map_exchange, "LONGEST_UPLOAD", 1 << 20)
    async with opening() as rig, rig.browser() as session:
        noise = np.random.default_rng(1).bytes(2 << 20)
        assert (await sent(session, "", ("lab.pgm", noise)))[1]["code"] == "too_large"


async def test_one_map_at_a_time_is_read(opening: Opening) -> None:
    async with opening() as rig, rig.browser() as session, rig.house.importing:
        assert (await sent(session, "", ("lab.pgm", PGM)))[0] == 503


async def test_a_disk_that_is_full_is_said_and_nothing_is_stored(
    opening: Opening, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opening() as rig, rig.browser() as session:
        monkeypatch.setattr(rig.control, "perform", _full)
        status, told = await sent(session, "?name=lab", ("lab.yaml", YAML), ("lab.pgm", PGM))
        assert (status, told["message"]) == (409, "cannot save map lab: No space left on device")


async def _full(*_: object) -> None:
    raise MissionError("cannot save map lab: No space left on device")
