"""``GET /metrics``: the text that Prometheus reads, in the old form or as OpenMetrics, as it asks."""

from collections.abc import Iterable, Iterator

from aiohttp import web
from prometheus_client import CollectorRegistry
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily, Metric
from prometheus_client.exposition import choose_encoder
from prometheus_client.registry import Collector

from robotd.core.errors import ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.front_door import FrontDoor, address_of
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.metrics.gateway_families import MissionEnds, of_gateway
from robotd.gateway.metrics.robot_families import MetricFamily, of_pose, of_status

_PREFIX = "robotd_"
_LOCAL = {"127.0.0.1", "::1"}
_KINDS = {"gauge": GaugeMetricFamily, "counter": CounterMetricFamily, "info": InfoMetricFamily}


def families(house: House, ends: MissionEnds) -> Iterator[MetricFamily]:
    """Yield all there is to tell now; of a robot that is not heard, only that."""
    yield from of_gateway(house, ends)
    snapshot = house.services.fan.snapshot
    if snapshot.status is not None:
        yield from of_status(snapshot.status)
        yield of_pose(snapshot.pose_state)


class _Told(Collector):
    def __init__(self, told: Iterable[MetricFamily]) -> None:
        self._told = tuple(told)

    def collect(self) -> Iterator[Metric]:
        """Yield the families in the library's form."""
        for family in self._told:
            made = _KINDS[family.kind](f"{_PREFIX}{family.name}", family.meaning)
            for labels, value in family.samples:
                suffix = {"gauge": "", "counter": "_total", "info": "_info"}[family.kind]
                made.add_sample(f"{_PREFIX}{family.name}{suffix}", dict(labels), value)
            yield made


def exposition(told: Iterable[MetricFamily], accept: str) -> tuple[bytes, str]:
    """Return the text of families and its type, in the newest form that is accepted."""
    registry = CollectorRegistry()
    registry.register(_Told(told))
    encode, content_type = choose_encoder(accept)
    return encode(registry), content_type


def route(ends: MissionEnds) -> Route:
    """Return the address of the metrics."""

    async def metrics(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
        """Tell Prometheus; it brings a token, or is on this machine where that is enough."""
        whence = address_of(request, ())
        if not (house.settings.access.metrics_without_token and whence in _LOCAL):
            scheme, secret = request.headers.get("Authorization", "").partition(" ")[::2]
            if scheme.lower() != "bearer":
                raise ServerError("not_signed_in", "bring a token: Authorization: Bearer TOKEN")
            FrontDoor(house).by_token(secret, whence)
        body, content_type = exposition(families(house, ends), request.headers.get("Accept", ""))
        return web.Response(body=body, headers={"Content-Type": content_type})

    return Route("GET", "/metrics", Needs.NOBODY, "metrics for Prometheus; a token, or this machine", metrics)
