"""The readers of other programs' maps and tables."""

import numpy as np

from robotd.core.errors import MapError, RecordingError
from robotd.grid.image import encode_pgm
from robotd.interop.grey_image import decode_grey, encode_png
from robotd.interop.map_server import import_map
from robotd.interop.map_server_yaml import MapServerYaml, decode_map_yaml
from robotd.logs.scan import RecordedLog
from robotd.logs.sweeps_csv import parse_sweeps
from robotd.sim.buildings.building import RecordedBuilding, encode_recorded_building, select_stops
from tests.studies.fuzz.target import KIB, MIB, Target
from tests.support.tum_reader import decode_tum

_GREY = np.arange(20, dtype=np.uint8).reshape(4, 5) * 13
_YAML = (
    b"image: a.pgm\nresolution: 0.05\norigin: [-1.0, -2.0, 0.5]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)
_TURNED = MapServerYaml("a.pgm", 0.05, -1.0, -2.0, 0.5, 0.65, 0.196, negate=False, mode="scale")


def _pictures() -> list[bytes]:
    plain = b"P2 # by hand\n2 2\n255\n0 205\n254 100\n"
    return [bytes(encode_pgm(_GREY)), encode_png(_GREY), encode_png(_GREY, _GREY > 100), plain]


def _table() -> list[bytes]:
    rows = [f"{at // 5},1,2,0.5,{at % 5 / 10},{at + 1}.5\n" for at in range(10)]
    degrees = b"# notes\nstop_x_cm,stop_y_cm,angle_deg,range_cm\n0,0,1.8,209\n0,0,3.6,\n0,0,5.4,inf\n"
    return ["".join(("sweep,x_m,y_m,heading_rad,bearing_rad,range_m\n", *rows)).encode(), degrees]


def _table_read(data: bytes) -> object:
    """What is read can be said, and makes a building."""
    log = parse_sweeps(data.decode("latin-1").splitlines())
    assert isinstance(log, RecordedLog)
    assert all(len(remark.splitlines()) == 1 for remark in log.remarks())
    return encode_recorded_building(RecordedBuilding("a.csv", select_stops(log)))


def _map_read(data: bytes) -> object:
    """What is no damaged picture is a map, however it is turned."""
    decode_grey(data)
    return import_map(_TURNED, data)


FORMATS = (
    Target(
        "sweeps-csv",
        _table_read,
        _table,
        ("robotd/logs/sweeps_csv.py",),
        typed=(RecordingError,),
        tokens=(b"inf", b"nan", b"range_m", b"_deg", b"_mm", b",", b"\n", b"heading_deg", b"1e9", b"-0"),
    ),
    Target("map-yaml", decode_map_yaml, lambda: [_YAML], ("robotd/interop/map_server_yaml.py",), typed=(MapError,)),
    Target(
        "map-picture",
        _map_read,
        _pictures,
        ("robotd/interop/grey_image.py", "robotd/interop/map_server.py"),
        typed=(MapError,),
        tokens=(b"P2\n", b"P5\n", b"65535\n", b"IHDR", b"tRNS", b"BM"),
        size_max=KIB,
        peak_max=64 * MIB,
    ),
    Target(
        "tum",
        lambda data: list(decode_tum(data.decode("latin-1").splitlines())),
        lambda: [b"# a\n1.5 1 2 0 0 0 0.1 0.99\n2 3 0 0 0 0 0 1\n"],
        ("robotd/interop/tum.py",),
        typed=(RecordingError,),
    ),
)
