"""What a gateway tells of itself: its browsers, its stops, who came in."""

from collections.abc import Iterator

from robotd import __version__
from robotd.contract.metric_families import MetricFamily
from robotd.contract.metrics import Buckets
from robotd.core.clock import now_ns
from robotd.gateway.house import House

_HEARD_WITHIN_S = 2.5


def of_gateway(house: House) -> Iterator[MetricFamily]:
    """Yield what a gateway knows of itself, and of the daemon by listening."""
    silent_s = house.services.fan.snapshot.silent_s(now_ns())
    is_up = silent_s is not None and silent_s < _HEARD_WITHIN_S
    yield MetricFamily("up", "gauge", "Whether the daemon is heard.", (((), float(is_up)),))
    yield MetricFamily("build", "info", "Versions.", (((("gateway", __version__),), 1.0),))
    yield MetricFamily("gateway_browsers", "gauge", "Pages that are open.", (((), float(len(house.connections))),))
    dropped = house.dropped_messages + sum(one.outbox.dropped for one in house.connections)
    yield _total("gateway_dropped_messages", "Messages left out for browsers that read slowly.", dropped)
    yield _total("gateway_messages", "Messages of the daemon that were handed on.", house.services.fan.frames)
    signed = (((("result", "done"),), float(house.sign_ins)), ((("result", "refused"),), float(house.refused_sign_ins)))
    yield MetricFamily("gateway_sign_ins", "counter", "Tokens that were tried.", signed)
    stops = house.services.stop_line
    took = Buckets.of("gateway_stop_seconds", {}, stops.seconds)
    yield MetricFamily("gateway_stop_seconds", "histogram", "Until a stop was confirmed.", (), (took,))
    told = (((("confirmed", "yes"),), float(stops.confirmed)), ((("confirmed", "no"),), float(stops.unconfirmed)))
    yield MetricFamily("gateway_stops", "counter", "Stops that were asked for here.", told)


def _total(name: str, meaning: str, count: int) -> MetricFamily:
    return MetricFamily(name, "counter", meaning, (((), float(count)),))
