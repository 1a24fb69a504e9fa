"""``GET /metrics``: the text that Prometheus reads, in the old form or as OpenMetrics, as it asks."""

import contextlib
from collections.abc import Iterable, Iterator

from aiohttp import web
from prometheus_client import CollectorRegistry
from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    InfoMetricFamily,
    Metric,
)
from prometheus_client.exposition import choose_encoder
from prometheus_client.registry import Collector

from robotd.contract.metric_families import MetricFamily, of_metrics, of_pose, of_status
from robotd.contract.metrics import Buckets
from robotd.contract.requests import GetMetrics
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.house import House
from robotd.gateway.http.front_door import FrontDoor, address_of
from robotd.gateway.http.route import Needs, Route
from robotd.gateway.metrics.gateway_families import of_gateway

_PREFIX = "robotd_"
_LOCAL = {"127.0.0.1", "::1"}
_PATIENCE_S = 2.0
_KINDS = {
    "gauge": GaugeMetricFamily,
    "counter": CounterMetricFamily,
    "info": InfoMetricFamily,
    "histogram": HistogramMetricFamily,
}
_ENDINGS = {"gauge": "", "counter": "_total", "info": "_info"}


async def families(house: House) -> list[MetricFamily]:
    """Return all there is to tell now; of a daemon that does not answer, only what is known of it."""
    told = list(of_gateway(house))
    snapshot = house.services.fan.snapshot
    if snapshot.status is not None:
        told += [*of_status(snapshot.status), of_pose(snapshot.pose_state)]
    with contextlib.suppress(RobotdError):
        told += of_metrics(await house.services.asker.ask(GetMetrics(), _PATIENCE_S))
    return told


class _Told(Collector):
    def __init__(self, told: Iterable[MetricFamily]) -> None:
        self._told = tuple(told)

    def collect(self) -> Iterator[Metric]:
        """Yield the families in the library's form."""
        for family in self._told:
            made = _KINDS[family.kind](f"{_PREFIX}{family.name}", family.meaning)
            for labels, value in family.samples:
                made.add_sample(f"{_PREFIX}{family.name}{_ENDINGS[family.kind]}", dict(labels), value)
            for one in family.distributions:
                _add_buckets(made, f"{_PREFIX}{family.name}", one)
            yield made


def _add_buckets(made: Metric, name: str, one: Buckets) -> None:
    bounds = [*(f"{bound:g}" for bound in one.bounds), "+Inf"]
    for bound, count in zip(bounds, one.counts, strict=True):
        made.add_sample(f"{name}_bucket", {**one.labels, "le": bound}, float(count))
    made.add_sample(f"{name}_count", one.labels, float(one.counts[-1]))
    made.add_sample(f"{name}_sum", one.labels, one.sum)


def exposition(told: Iterable[MetricFamily], accept: str) -> tuple[bytes, str]:
    """Return the text of families and its type, in the newest form that is accepted."""
    registry = CollectorRegistry()
    registry.register(_Told(told))
    encode, content_type = choose_encoder(accept)
    return encode(registry), content_type


async def metrics(request: web.Request, house: House, _: Person | None) -> web.StreamResponse:
    """Tell Prometheus; it brings a token, or is on this machine where that is enough."""
    whence = address_of(request, ())
    if not (house.settings.access.metrics_without_token and whence in _LOCAL):
        scheme, secret = request.headers.get("Authorization", "").partition(" ")[::2]
        if scheme.lower() != "bearer":
            raise ServerError("not_signed_in", "bring a token: Authorization: Bearer TOKEN")
        FrontDoor(house).by_token(secret, whence)
    body, content_type = exposition(await families(house), request.headers.get("Accept", ""))
    return web.Response(body=body, headers={"Content-Type": content_type})


ROUTE = Route("GET", "/metrics", Needs.NOBODY, "metrics for Prometheus; a token, or this machine", metrics)
