"""What a robot did, as one page of HTML: without script, without anything from elsewhere, to be opened offline."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from html import escape

from robotd.core.clock import NS_PER_S
from robotd.interop.mission_facts import MissionFacts
from robotd.interop.report_picture import picture

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;"
    "background:#fff}h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:2rem}svg{max-width:100%;height:auto;"
    "border:1px solid #ccc}table{border-collapse:collapse;width:100%}th,td{text-align:left;padding:.25rem .6rem;"
    "border-bottom:1px solid #ddd;vertical-align:top}code{overflow-wrap:anywhere}"
    "@media(prefers-color-scheme:dark){body{color:#e6e6e6;background:#161616}th,td{border-color:#444}}"
)


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a page comes from, and how far it can be relied on."""

    name: str
    """Of the recording."""
    recorded_by: str
    """Version of the daemon."""
    began_unix_s: float
    wall_offset_ns: int
    duration_s: float
    recorded_digest: str
    replayed_digest: str
    """Over all results: the same if the replay came to what was recorded."""
    is_whole: bool
    """Whether the recording was ended properly."""


def page(facts: MissionFacts, source: Provenance) -> str:
    """Return the page."""
    title = f"Mission report: {source.name}"
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head><body>'
        f"<h1>{escape(title)}</h1>{_provenance(source)}{_map(facts)}"
        f"{_table('Missions', ('', 'kind', 'began', 'took', 'end', 'message'), _missions(facts, source))}"
        f"{_table('Stops', ('mission', 'stop', 'at', 'state', 'why', 'nearest'), _stops(facts))}"
        f"{_table('Looks round', ('when', 'estimate'), _looks(facts, source))}"
        f"{_table('Failures, and when it was stopped', ('when', 'what', 'why'), _failures(facts, source))}"
        f"{_table('Lines', ('device', 'link', 'faults', 'counted'), _lines(facts))}</body></html>\n"
    )


def _provenance(source: Provenance) -> str:
    began = datetime.fromtimestamp(source.began_unix_s, UTC)
    same = source.recorded_digest == source.replayed_digest
    rows = (
        ("recorded", f"{began:%Y-%m-%d %H:%M:%S} UTC, {source.duration_s:.1f} s, by robotd {source.recorded_by}"),
        ("whole", "yes" if source.is_whole else "no: it was cut off"),
        ("digest of its results", source.recorded_digest),
        ("computed again", "the same" if same else f"otherwise: {source.replayed_digest}"),
    )
    return _rows(rows)


def _map(facts: MissionFacts) -> str:
    drawn = picture(facts)
    if not drawn:
        return "<h2>Map</h2><p>No map was in use.</p>"
    legend = (
        "Line: where the robot was believed to be. Circles: stops that were swept or wait, crosses: stops that were not"
        " reached. Squares: looks round, full where there was one answer."
    )
    return f"<h2>Map and way</h2>{drawn}<p>{legend}</p>"


def _missions(facts: MissionFacts, source: Provenance) -> Iterable[Sequence[str]]:
    for span in facts.missions.values():
        took_s = (span.last.time_ns - span.begun_ns) / NS_PER_S
        began = _when(span.begun_ns, source)
        yield str(span.mission_id), span.kind, began, f"{took_s:.1f} s", span.last.phase, span.last.message


def _stops(facts: MissionFacts) -> Iterable[Sequence[str]]:
    for span in facts.missions.values():
        for number, stop in enumerate(span.plan.stops if span.plan else ()):
            nearest = "" if stop.nearest_m is None else _place(*stop.nearest_m)
            where = _place(stop.x_m, stop.y_m)
            yield str(span.mission_id), str(number), where, _words(stop.state), _words(stop.reason or ""), nearest


def _looks(facts: MissionFacts, source: Provenance) -> Iterable[Sequence[str]]:
    for look in facts.looks:
        yield _when(look.time_ns, source), str(look)


def _failures(facts: MissionFacts, source: Provenance) -> Iterable[Sequence[str]]:
    found = [
        *(
            (span.last.time_ns, f"mission {span.mission_id} {span.last.phase}", span.last.message)
            for span in facts.failures
        ),
        *((halt.time_ns, halt.mode, halt.reason) for halt in facts.halts),
    ]
    return ((_when(time_ns, source), what, why) for time_ns, what, why in sorted(found))


def _lines(facts: MissionFacts) -> Iterable[Sequence[str]]:
    for device in facts.devices:
        counted = ", ".join(f"{name} {count}" for name, count in device.counters)
        yield device.name, device.link, ", ".join(device.faults) or "none", counted


def _table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    if not body:
        return f"<h2>{escape(title)}</h2><p>None.</p>"
    head = "".join(f'<th scope="col">{escape(column)}</th>' for column in columns)
    return f"<h2>{escape(title)}</h2><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _rows(rows: Iterable[tuple[str, str]]) -> str:
    body = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td><code>{escape(value)}</code></td></tr>' for name, value in rows
    )
    return f"<table><tbody>{body}</tbody></table>"


def _when(time_ns: int, source: Provenance) -> str:
    return f"{datetime.fromtimestamp((time_ns + source.wall_offset_ns) / NS_PER_S, UTC):%H:%M:%S}"


def _place(x_m: float, y_m: float) -> str:
    return f"({x_m:.2f}, {y_m:.2f}) m"


def _words(word: str) -> str:
    return word.replace("_", " ")
